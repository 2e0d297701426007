#include "tests/support/make_mesh.h"

#include <cmath>
#include <glm/geometric.hpp>

#include <algorithm>
#include <map>
#include <random>
#include <utility>

namespace rt::test {
namespace {

glm::vec3 normalOrUp(const glm::vec3& n) {
    const float length = glm::length(n);
    return length > 0.0f ? n / length : glm::vec3(0.0f, 0.0f, 1.0f);
}

Mesh withGreyMaterial(std::vector<glm::vec3> positions, std::vector<glm::vec3> normals,
                      std::vector<glm::uvec3> triangles) {
    Mesh mesh;
    mesh.triangleMaterial = std::vector<std::uint32_t>(triangles.size(), 0u);
    mesh.positions = std::move(positions);
    mesh.normals = std::move(normals);
    mesh.triangles = std::move(triangles);
    mesh.materials = std::vector<Material>{greyMaterial()};
    return mesh;
}

// Splits each triangle into four, with the new vertices pushed out to the unit sphere.
void subdivide(std::vector<glm::vec3>& vertices, std::vector<glm::uvec3>& triangles) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
        const auto [entry, isNew] =
            middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(vertices.size()));
        if (isNew) vertices.push_back(glm::normalize(vertices[a] + vertices[b]));
        return entry->second;
    };
    std::vector<glm::uvec3> split;
    split.reserve(triangles.size() * 4);
    for (const glm::uvec3& t : triangles) {
        const glm::uvec3 m(middle(t.x, t.y), middle(t.y, t.z), middle(t.z, t.x));
        split.insert(split.end(), {{t.x, m.x, m.z}, {t.y, m.y, m.x}, {t.z, m.z, m.y}, m});
    }
    triangles = std::move(split);
}

} // namespace

Material greyMaterial() {
    Material material = diffuseMaterial(glm::vec3(0.8f));
    material.transmission.y = 1.5f;
    return material;
}

Mesh makeTriangles(const std::vector<glm::vec3>& corners) {
    std::vector<glm::vec3> normals;
    std::vector<glm::uvec3> triangles;
    for (std::uint32_t i = 0; i + 2 < corners.size(); i += 3) {
        const glm::vec3 n = glm::cross(corners[i + 1] - corners[i], corners[i + 2] - corners[i]);
        normals.insert(normals.end(), 3, normalOrUp(n));
        triangles.emplace_back(i, i + 1, i + 2);
    }
    return withGreyMaterial(corners, std::move(normals), std::move(triangles));
}

Mesh makeIndexed(std::vector<glm::vec3> positions, std::vector<glm::uvec3> triangles) {
    std::vector<glm::vec3> normals(positions.size(), glm::vec3(0.0f, 0.0f, 1.0f));
    return withGreyMaterial(std::move(positions), std::move(normals), std::move(triangles));
}

Mesh makeSphere(int subdivisions, float radius) {
    const float g = 1.618033989f; // golden ratio
    std::vector<glm::vec3> vertices = {{-1, g, 0}, {1, g, 0}, {-1, -g, 0}, {1, -g, 0},
                                       {0, -1, g}, {0, 1, g}, {0, -1, -g}, {0, 1, -g},
                                       {g, 0, -1}, {g, 0, 1}, {-g, 0, -1}, {-g, 0, 1}};
    for (glm::vec3& v : vertices) v = glm::normalize(v);
    std::vector<glm::uvec3> triangles = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                                         {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                                         {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                                         {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
    for (int i = 0; i < subdivisions; ++i) subdivide(vertices, triangles);
    std::vector<glm::vec3> normals = vertices;
    for (glm::vec3& v : vertices) v *= radius;
    return withGreyMaterial(std::move(vertices), std::move(normals), std::move(triangles));
}

Mesh makeTorus(float radius, float tube, int around, int across) {
    constexpr float kTurn = 6.2831853f;
    std::vector<glm::vec3> positions, normals;
    std::vector<glm::uvec3> triangles;
    for (int i = 0; i < around; ++i)
        for (int j = 0; j < across; ++j) {
            const float a = kTurn * static_cast<float>(i) / static_cast<float>(around);
            const float b = kTurn * static_cast<float>(j) / static_cast<float>(across);
            const glm::vec3 outward(std::cos(a), std::sin(a), 0.0f);
            normals.push_back(outward * std::cos(b) + glm::vec3(0.0f, 0.0f, std::sin(b)));
            positions.push_back(outward * radius + normals.back() * tube);
            const auto at = [&](int k, int l) {
                return static_cast<std::uint32_t>((k % around) * across + l % across);
            };
            triangles.emplace_back(at(i, j), at(i + 1, j), at(i + 1, j + 1));
            triangles.emplace_back(at(i, j), at(i + 1, j + 1), at(i, j + 1));
        }
    return withGreyMaterial(std::move(positions), std::move(normals), std::move(triangles));
}

Mesh makeSheet(int alongX, int alongY) {
    std::vector<glm::vec3> positions;
    std::vector<glm::uvec3> triangles;
    for (int j = 0; j <= alongY; ++j)
        for (int i = 0; i <= alongX; ++i) {
            positions.emplace_back(2.0f * static_cast<float>(i) / static_cast<float>(alongX) - 1.0f,
                                   2.0f * static_cast<float>(j) / static_cast<float>(alongY) - 1.0f, 0.0f);
            if (i == alongX || j == alongY) continue;
            const auto at = static_cast<std::uint32_t>(j * (alongX + 1) + i);
            const auto above = at + static_cast<std::uint32_t>(alongX) + 1;
            triangles.emplace_back(at, at + 1, above + 1);
            triangles.emplace_back(at, above + 1, above);
        }
    return makeIndexed(std::move(positions), std::move(triangles));
}

Mesh makeBox(const glm::vec3& lo, const glm::vec3& hi) {
    std::vector<glm::vec3> positions;
    std::vector<glm::vec3> normals;
    std::vector<glm::uvec3> triangles;
    for (int axis = 0; axis < 3; ++axis) {
        const int u = (axis + 1) % 3;
        const int v = (axis + 2) % 3;
        for (const bool top : {false, true}) {
            const auto first = static_cast<std::uint32_t>(positions.size());
            for (const auto& [pickU, pickV] : {std::pair(0, 0), {1, 0}, {1, 1}, {0, 1}}) {
                glm::vec3 corner;
                corner[axis] = top ? hi[axis] : lo[axis];
                corner[u] = pickU ? hi[u] : lo[u];
                corner[v] = pickV ? hi[v] : lo[v];
                positions.push_back(corner);
                normals.emplace_back(0.0f);
                normals.back()[axis] = top ? 1.0f : -1.0f;
            }
            for (const glm::uvec3 t : {glm::uvec3(0, 1, 2), glm::uvec3(0, 2, 3)})
                triangles.push_back(first + (top ? t : glm::uvec3(t.x, t.z, t.y)));
        }
    }
    return withGreyMaterial(std::move(positions), std::move(normals), std::move(triangles));
}

Mesh makeCube() {
    return makeBox(glm::vec3(-0.5f), glm::vec3(0.5f));
}

Mesh makeRandomTriangles(std::size_t count, std::uint64_t seed, float size) {
    std::mt19937_64 random(seed);
    // The top 24 bits: std::uniform_real_distribution may differ between standard libraries.
    const auto unit = [&] { return static_cast<float>(random() >> 40) * 0x1p-24f; };
    const auto point = [&] {
        const float x = unit();
        const float y = unit();
        return glm::vec3(x, y, unit());
    };
    std::vector<glm::vec3> corners;
    corners.reserve(count * 3);
    for (std::size_t i = 0; i < count; ++i) {
        const glm::vec3 centre = point();
        for (int corner = 0; corner < 3; ++corner)
            corners.push_back(centre + (point() - glm::vec3(0.5f)) * (2.0f * size));
    }
    return makeTriangles(corners);
}

Mesh makeSliversAndGiants(int count) {
    std::mt19937_64 random(3);
    const auto unit = [&] { return static_cast<float>(random() >> 40) * 0x1p-24f; };
    const auto point = [&](float size) { return glm::vec3(unit(), unit(), unit()) * size; };
    std::vector<glm::vec3> corners;
    for (int i = 0; i < count; ++i) {
        const glm::vec3 a = point(1.0f);
        const glm::vec3 b = point(1.0f);
        corners.insert(corners.end(), {a, b, a + (b - a) * unit() + point(1e-6f)}); // sliver
        if (i % 20 == 0) corners.insert(corners.end(), {point(1.0f), point(1.0f), point(1.0f)});
    }
    return makeTriangles(corners);
}

Mesh makeFan(int count) {
    std::mt19937_64 random(5);
    const auto unit = [&] { return static_cast<float>(random() >> 40) * 0x1p-24f; };
    const auto point = [&] { return glm::vec3(unit(), unit(), unit()); };
    std::vector<glm::vec3> corners;
    for (int i = 0; i < count; ++i) corners.insert(corners.end(), {glm::vec3(0.5f), point(), point()});
    return makeTriangles(corners);
}

Mesh joined(const Mesh& a, const Mesh& b) {
    std::vector<glm::vec3> positions(a.positions.begin(), a.positions.end());
    std::vector<glm::vec3> normals(a.normals.begin(), a.normals.end());
    std::vector<glm::uvec3> triangles(a.triangles.begin(), a.triangles.end());
    for (const glm::uvec3& t : b.triangles)
        triangles.push_back(t + static_cast<std::uint32_t>(positions.size()));
    positions.insert(positions.end(), b.positions.begin(), b.positions.end());
    normals.insert(normals.end(), b.normals.begin(), b.normals.end());
    return withGreyMaterial(std::move(positions), std::move(normals), std::move(triangles));
}

Mesh makeTexturedSquare(const std::vector<glm::uvec2>& imageSizes) {
    Mesh mesh =
        withGreyMaterial({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}},
                         std::vector<glm::vec3>(4, glm::vec3(0.0f, 0.0f, 1.0f)), {{0, 1, 2}, {0, 2, 3}});
    mesh.texcoords = std::vector<glm::vec2>{{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    Material material = greyMaterial();
    material.images.x = imageSizes.empty() ? kNoImage : 0u;
    mesh.materials = std::vector<Material>{material};
    std::vector<MeshImage> images;
    std::uint64_t pixelCount = 0;
    for (const glm::uvec2& size : imageSizes) {
        images.push_back({size.x, size.y, kWrapRepeat, kWrapClamp, pixelCount, kImageSrgb, 0});
        pixelCount += std::uint64_t(size.x) * size.y;
    }
    std::vector<std::uint32_t> pixels(pixelCount);
    for (std::size_t i = 0; i < pixels.size(); ++i) pixels[i] = 0xFF000000u + static_cast<std::uint32_t>(i);
    mesh.images = std::move(images);
    mesh.pixels = std::move(pixels);
    return mesh;
}

Mesh moved(const Mesh& mesh, float scale, const glm::vec3& offset) {
    std::vector<glm::vec3> positions(mesh.positions.begin(), mesh.positions.end());
    for (glm::vec3& p : positions) p = p * scale + offset;
    Mesh result = mesh;
    result.positions = std::move(positions);
    return result;
}

} // namespace rt::test

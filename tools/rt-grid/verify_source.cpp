#include "tools/rt-grid/verify_source.h"

#include "common/bounds.h"
#include "formats/octahedral.shared.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rt {
namespace {

constexpr std::size_t kPerBlock = 4096;

template <class T>
bool sameBytes(const T& a, const T& b) {
    return std::ranges::equal(std::as_bytes(std::span(&a, 1)), std::as_bytes(std::span(&b, 1)));
}

// The first place where two arrays differ, or that they are not equally long.
template <class A, class B, class Same>
Faults compare(WorkMeter& meter, const char* what, const A& inAtlas, const B& inMesh, const Same& same) {
    Faults faults;
    if (inAtlas.size() != inMesh.size()) {
        faults.add(
            [&] { return fmt::format("{} {}s, but the mesh has {}", inAtlas.size(), what, inMesh.size()); });
        return faults;
    }
    return findFaults(inAtlas.size(), kPerBlock, meter,
                      [&](std::size_t begin, std::size_t end, Faults& found) {
                          for (std::size_t i = begin; i < end; ++i)
                              if (!same(inAtlas[i], inMesh[i]))
                                  found.add([&] { return fmt::format("{} {} is not the mesh's", what, i); });
                      });
}

// Numbers that the scale takes below 2^-126 lose digits.
bool isMoved(const glm::vec4& corner, const glm::vec3& position, const glm::vec4& offset) {
    for (int axis = 0; axis < 3; ++axis) {
        const double wanted = (double(position[axis]) - double(offset[axis])) * double(offset.w);
        if (std::abs(corner[axis] - wanted) > (std::abs(wanted) < 0x1p-126 ? 0x1p-149 : 0.0)) return false;
    }
    return true;
}

Faults compareCorners(const Atlas& atlas, const Mesh& mesh, WorkMeter& meter) {
    return compare(meter, "triangle", atlas.triangles, mesh.triangles,
                   [&](const TriangleRecord& t, const glm::uvec3& v) {
                       const glm::vec4& offset = atlas.grid.worldOffset;
                       return isMoved(t.v0, mesh.positions[v.x], offset) &&
                              isMoved(t.v1, mesh.positions[v.y], offset) &&
                              isMoved(t.v2, mesh.positions[v.z], offset);
                   });
}

Faults compareIndices(const Atlas& atlas, const Mesh& mesh, WorkMeter& meter) {
    const glm::uvec3* const first = mesh.triangles.data();
    return compare(meter, "triangle's vertices or material, of triangle", atlas.triangleVertices,
                   mesh.triangles, [&](const glm::uvec4& found, const glm::uvec3& v) {
                       return found ==
                              glm::uvec4(v, mesh.triangleMaterial[static_cast<std::size_t>(&v - first)]);
                   });
}

// Without images in sight an atlas leaves them, and what leads to them, out.
bool isSameMaterial(const Material& inAtlas, Material inMesh, bool hasImages) {
    if (!hasImages) {
        inMesh.images = glm::uvec4(kNoImage);
        inMesh.more.x = kNoImage;
    }
    return sameBytes(inAtlas, inMesh);
}

bool hasPixels(const Atlas& atlas, const ImagePlace& place, const Mesh& mesh, const MeshImage& image) {
    if (place.rect.z != image.width || place.rect.w != image.height || place.page.y != image.wrapU ||
        place.page.z != image.wrapV || place.page.w != image.space)
        return false;
    for (std::uint32_t y = 0; y < image.height; ++y) {
        const std::size_t line = std::size_t(place.page.x) * atlas.info.pageHeight + place.rect.y + y;
        const std::uint32_t* const found = &atlas.pages[line * atlas.info.pageWidth + place.rect.x];
        if (!std::equal(found, found + image.width,
                        &mesh.pixels[image.firstPixel + std::size_t(y) * image.width]))
            return false;
    }
    return true;
}

} // namespace

Faults verifySource(const Atlas& atlas, const MeshFile& meshFile, WorkMeter& meter) {
    const Mesh& mesh = meshFile.mesh;
    Faults faults;
    if (atlas.info.meshHash != meshFile.contentHash)
        faults.add([&] {
            return fmt::format("it was made from a mesh with hash {:016x}, not {:016x}", atlas.info.meshHash,
                               meshFile.contentHash);
        });
    faults.append(compareCorners(atlas, mesh, meter));
    faults.append(compareIndices(atlas, mesh, meter));
    faults.append(compare(meter, "normal", atlas.normals, mesh.normals,
                          [](std::uint32_t a, const glm::vec3& b) { return a == octEncode(b); }));
    const bool hasImages = !atlas.texcoords.empty();
    if (hasImages) {
        faults.append(
            compare(meter, "texture coordinate", atlas.texcoords, mesh.texcoords, sameBytes<glm::vec2>));
        faults.append(
            compare(meter, "image", atlas.images, mesh.images,
                    [&](const ImagePlace& a, const MeshImage& b) { return hasPixels(atlas, a, mesh, b); }));
    }
    faults.append(
        compare(meter, "material", atlas.materials, mesh.materials,
                [&](const Material& a, const Material& b) { return isSameMaterial(a, b, hasImages); }));
    faults.append(compare(meter, "light", atlas.lights, mesh.lights, sameBytes<Light>));
    faults.append(compare(meter, "camera", atlas.cameras, mesh.cameras, sameBytes<NamedCamera>));
    faults.append(
        compare(meter, "frame of a camera's path", atlas.cameraKeys, mesh.cameraKeys, sameBytes<CameraKey>));
    faults.append(
        compare(meter, "background", atlas.surroundings, mesh.surroundings, sameBytes<Surroundings>));
    faults.append(compare(meter, "pixel of the environment", atlas.environment, mesh.environment,
                          sameBytes<glm::vec3>));
    return faults;
}

Faults verifyBounds(const Atlas& atlas) {
    BoundsD bounds;
    for (const TriangleRecord& t : atlas.triangles)
        for (const glm::vec4& v : {t.v0, t.v1, t.v2}) bounds.add(glm::dvec3(v));
    Faults faults;
    const glm::vec4& offset = atlas.grid.worldOffset;
    const double slack = 0x1p-148 / double(offset.w); // of numbers that the scale takes below 2^-126
    for (int axis = 0; axis < 3; ++axis) {
        const double lo = bounds.lo[axis] / double(offset.w) + double(offset[axis]);
        const double hi = bounds.hi[axis] / double(offset.w) + double(offset[axis]);
        if (std::abs(lo - atlas.info.worldLo[axis]) > slack ||
            std::abs(hi - atlas.info.worldHi[axis]) > slack)
            faults.add([&] {
                return fmt::format("along {} the triangles reach from {} to {}, but INFO says {} to {}",
                                   "xyz"[axis], lo, hi, atlas.info.worldLo[axis], atlas.info.worldHi[axis]);
            });
    }
    return faults;
}

} // namespace rt

#pragma once
#include "common/error.h"
#include "formats/mesh.h"
#include "tests/support/read_text.h"

#include <gtest/gtest.h>

#include <fstream>
#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace rt::test {

inline Material greyMaterial(std::uint32_t image) {
    Material material = diffuseMaterial(glm::vec3(0.5f));
    material.reflection.w = 0.25f;
    material.transmission = glm::vec4(0.5f, 1.5f, 0.0f, 0.0f);
    material.images.x = image;
    return material;
}

inline CameraKey keyAt(std::uint32_t camera, double frame) {
    CameraKey key;
    key.frame = frame;
    key.eye = {frame, 0, 4};
    key.fovDegrees = 30.0;
    key.camera = camera;
    return key;
}

/// Two cameras, of which one moves, and an environment of two pixels, for a Mesh or an Atlas.
template <class Scene>
void addScenery(Scene& scene) {
    NamedCamera camera{"a", {0, 0, 4}, {0, 0, 0}, {0, 1, 0}, 30.0, 0, 0, 0, kCameraPerspective, 0};
    NamedCamera round = camera;
    round.name[0] = 'b';
    round.kind = kCameraPanorama;
    scene.cameras = std::vector<NamedCamera>{camera, round};
    scene.cameraKeys = std::vector<CameraKey>{keyAt(0, 1), keyAt(0, 2.5), keyAt(1, -1)};
    scene.surroundings = std::vector<Surroundings>{{{1, 2, 3}, 1, 0.5f, 90.0f, 2, 1}};
    scene.environment = std::vector<glm::vec3>{{0, 0, 0}, {1, 2, 1000}};
}

/// What can be wrong with that, each with what it is.
template <class Scene>
std::vector<std::pair<const char*, std::function<void(Scene&)>>> wrongScenery() {
    const auto keys = [](std::vector<CameraKey> wrong) {
        return [=](Scene& s) { s.cameraKeys = std::vector<CameraKey>(wrong); };
    };
    const auto around = [](Surroundings wrong) {
        return [=](Scene& s) { s.surroundings = std::vector<Surroundings>{wrong}; };
    };
    const float inf = std::numeric_limits<float>::infinity();
    CameraKey flat = keyAt(0, 1), lost = keyAt(0, 1);
    flat.fovDegrees = 180.0;
    lost.eye.x = double(inf);
    return {{"frames are not in order", keys({keyAt(0, 2), keyAt(0, 1)})},
            {"a frame twice", keys({keyAt(0, 1), keyAt(0, 1)})},
            {"cameras are not in order", keys({keyAt(1, 1), keyAt(0, 2)})},
            {"no such camera", keys({keyAt(2, 1)})},
            {"no view", keys({flat})},
            {"nowhere", keys({lost})},
            {"pixels are missing", around({{0, 0, 0}, 0, 1, 0, 2, 2})},
            {"pixels are too many", around({{0, 0, 0}, 0, 1, 0, 0, 0})},
            {"a side of 0", around({{0, 0, 0}, 0, 1, 0, 2, 0})},
            {"a negative background", around({{-1, 0, 0}, 1, 1, 0, 2, 1})},
            {"neither stated nor not", around({{0, 0, 0}, 2, 1, 0, 2, 1})},
            {"an infinite strength", around({{0, 0, 0}, 0, inf, 0, 2, 1})},
            {"a negative strength", around({{0, 0, 0}, 0, -1, 0, 2, 1})},
            {"an infinite turn", around({{0, 0, 0}, 0, 1, inf, 2, 1})},
            {"pixels without a size", [](Scene& s) { s.surroundings = {}; }},
            {"two surroundings",
             [](Scene& s) { s.surroundings = std::vector<Surroundings>(2, s.surroundings[0]); }},
            {"darkness", [](Scene& s) {
                 s.environment = std::vector<glm::vec3>{{0, 0, 0}, {0, -1, 0}};
             }}};
}

/// Two triangles with all that a mesh may have but scenery.
inline Mesh smallMesh() {
    Mesh mesh;
    mesh.positions = std::vector<glm::vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0.5f}};
    mesh.normals = std::vector<glm::vec3>(4, glm::vec3(0, 0, 1));
    mesh.texcoords = std::vector<glm::vec2>{{0, 0}, {1, 0}, {0, 1}, {1, 1}};
    mesh.triangles = std::vector<glm::uvec3>{{0, 1, 2}, {1, 3, 2}};
    mesh.triangleMaterial = std::vector<std::uint32_t>{0, 0};
    mesh.materials = std::vector<Material>{greyMaterial(0)};
    mesh.lights = std::vector<Light>{pointLight({1, 2, 3}, {4, 5, 6})};
    mesh.images = std::vector<MeshImage>{{2, 1, kWrapRepeat, kWrapClamp, 0, kImageSrgb, 0}};
    mesh.pixels = std::vector<std::uint32_t>{0xFF0000FFu, 0xFF00FF00u};
    return mesh;
}

/// What an array holds, to be compared.
template <class T>
std::string bytes(const SharedSpan<T>& values) {
    return {reinterpret_cast<const char*>(values.data()), values.size_bytes()};
}

inline void spill(const std::string& path, const std::string& content) {
    std::ofstream(path, std::ios::binary | std::ios::trunc) << content;
}

/// Of the Error that it throws; Internal if it throws none.
inline ErrorKind failureOf(const std::function<void()>& read) {
    try {
        read();
    } catch (const Error& error) {
        return error.kind();
    }
    return ErrorKind::Internal;
}

/// Cuts the file anywhere, makes it longer, and changes a bit of every byte.
inline void expectEveryDamageIsRefused(const std::string& path, const std::function<void()>& read) {
    const std::string good = readText(path);
    ASSERT_GT(good.size(), 500u);
    for (std::size_t length = 0; length < good.size(); ++length) {
        spill(path, good.substr(0, length));
        ASSERT_EQ(failureOf(read), ErrorKind::InvalidContent) << "cut to " << length << " bytes";
    }
    spill(path, good + '\0');
    EXPECT_EQ(failureOf(read), ErrorKind::InvalidContent) << "one byte more";
    for (std::size_t i = 0; i < good.size(); ++i) {
        std::string bad = good;
        bad[i] = static_cast<char>(bad[i] ^ (1 << (i % 8)));
        spill(path, bad);
        ASSERT_EQ(failureOf(read), ErrorKind::InvalidContent) << "byte " << i;
    }
    spill(path, good);
    EXPECT_NO_THROW(read());
}

} // namespace rt::test

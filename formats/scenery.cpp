// Materials, lights, cameras and what is behind the scene: what they may be.
#include "formats/mesh.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <set>
#include <string_view>

namespace rt {
namespace {

bool finite(const glm::vec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}
bool finite(const double (&v)[3]) {
    return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]);
}
bool inUnitRange(float x) {
    return x >= 0.0f && x <= 1.0f;
}
bool inUnitRange(const glm::vec3& v) {
    return inUnitRange(v.x) && inUnitRange(v.y) && inUnitRange(v.z);
}
bool isRadiance(const glm::vec4& v) {
    return finite(glm::vec3(v)) && std::min({v.x, v.y, v.z}) >= 0.0f && v.w == 0.0f;
}
bool isUnit(const glm::vec3& n) {
    return std::abs(glm::dot(n, n) - 1.0f) < 1e-3f;
} // false for NaN

bool finite(const glm::dvec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}
bool isViewAngle(double degrees) {
    return degrees > 0.0 && degrees < 180.0;
}

bool isName(const char (&name)[64]) {
    const std::string_view text(name, strnlen(name, sizeof(name)));
    return !text.empty() && text.size() < sizeof(name) && std::none_of(text.begin(), text.end(), [](char c) {
        return static_cast<unsigned char>(c) < 32;
    }) && std::all_of(name + text.size(), name + sizeof(name), [](char c) { return c == 0; });
}

} // namespace

Material diffuseMaterial(const glm::vec3& baseColor) {
    return {glm::vec4(baseColor, 1.0f),        glm::vec4(0.0f), glm::vec4(0.0f, 1.0f, 0.0f, 0.0f),
            glm::vec4(0.0f, 1.0f, 0.0f, 0.0f), glm::vec4(1.0f), glm::uvec4(kNoImage),
            glm::uvec4(kNoImage, 0u, 0u, 0u)};
}

Light pointLight(const glm::vec3& position, const glm::vec3& intensity) {
    Light light{};
    light.position = glm::vec4(position, 0.0f);
    light.intensity = glm::vec4(intensity, 0.0f);
    light.kind.x = kLightPoint;
    return light;
}

bool isValid(const Material& m, std::size_t imageCount) {
    const auto isImage = [&](std::uint32_t image) { return image == kNoImage || image < imageCount; };
    const bool transmits = inUnitRange(m.transmission.x) && m.transmission.y >= 1.0f &&
                           m.transmission.y <= 100.0f && m.transmission.z >= 0.0f &&
                           std::isfinite(m.transmission.z) && inUnitRange(m.transmission.w);
    const bool reflects = inUnitRange(glm::vec3(m.reflection)) && inUnitRange(m.reflection.w);
    return inUnitRange(glm::vec3(m.baseColor)) && inUnitRange(m.baseColor.w) && isRadiance(m.emission) &&
           reflects && transmits && inUnitRange(glm::vec3(m.attenuation)) && std::isfinite(m.attenuation.w) &&
           isImage(m.images.x) && isImage(m.images.y) && isImage(m.images.z) && isImage(m.images.w) &&
           isImage(m.more.x) && (m.more.y & ~kMaterialBits) == 0 && m.more.z == 0 && m.more.w == 0;
}

bool isValid(const Light& light) {
    if (!finite(glm::vec3(light.position)) || !isRadiance(light.intensity) ||
        light.kind.x >= kLightKindCount || light.kind.y != 0 || light.kind.z != 0 || light.kind.w != 0)
        return false;
    const std::uint32_t kind = light.kind.x;
    const bool isDirected = kind == kLightDirectional || kind == kLightSpot || kind == kLightRectangle;
    if (isDirected && !isUnit(glm::vec3(light.direction))) return false;
    if (kind == kLightSpot)
        return light.direction.w >= -1.0f && light.direction.w <= light.edgeU.w && light.edgeU.w <= 1.0f;
    if (kind == kLightRectangle) {
        const glm::vec3 u(light.edgeU), v(light.edgeV);
        const float area = glm::length(glm::cross(u, v));
        return finite(u) && finite(v) && area > 0.0f && std::isfinite(area);
    }
    return kind != kLightSphere || (light.position.w > 0.0f && std::isfinite(light.position.w));
}

bool isValid(const NamedCamera& c) {
    const bool shows = c.kind == kCameraPanorama ||
                       (c.kind == kCameraOrthographic ? c.height > 0.0 && std::isfinite(c.height)
                                                      : isViewAngle(c.fovDegrees));
    const bool focuses = c.lensRadius == 0.0 || (c.lensRadius > 0.0 && std::isfinite(c.lensRadius) &&
                                                 c.focusDistance > 0.0 && std::isfinite(c.focusDistance));
    return isName(c.name) && finite(c.eye) && finite(c.lookAt) && finite(c.up) && c.kind < kCameraKinds &&
           c.zero == 0 && shows && focuses;
}

bool haveUniqueNames(std::span<const NamedCamera> cameras) {
    std::set<std::string_view> names;
    return std::all_of(cameras.begin(), cameras.end(),
                       [&](const NamedCamera& camera) { return names.insert(camera.name).second; });
}

bool areValid(std::span<const CameraKey> keys, std::size_t cameraCount) {
    const CameraKey* before = nullptr;
    for (const CameraKey& key : keys) {
        const bool inOrder = !before || before->camera < key.camera ||
                             (before->camera == key.camera && before->frame < key.frame);
        if (!inOrder || key.camera >= cameraCount || key.zero != 0 || !std::isfinite(key.frame) ||
            !finite(key.eye) || !finite(key.lookAt) || !finite(key.up) || !isViewAngle(key.fovDegrees))
            return false;
        before = &key;
    }
    return true;
}

bool isLight(const glm::vec3& radiance) {
    return finite(radiance) && std::min({radiance.x, radiance.y, radiance.z}) >= 0.0f;
}

bool areValid(std::span<const Surroundings> surroundings, std::size_t environmentPixels) {
    if (surroundings.empty()) return environmentPixels == 0;
    const Surroundings& s = surroundings[0];
    return surroundings.size() == 1 && s.hasBackground <= 1 &&
           isLight({s.background[0], s.background[1], s.background[2]}) && s.strength >= 0.0f &&
           std::isfinite(s.strength) && std::isfinite(s.turnDegrees) && (s.width > 0) == (s.height > 0) &&
           std::uint64_t(s.width) * s.height == environmentPixels;
}

} // namespace rt

#include "tools/rt-import/place_scenery.h"

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <cmath>

namespace rt {
namespace {

glm::dvec3 pointUnder(const glm::dmat4& placement, const glm::dvec3& point) {
    return glm::dvec3(placement * glm::dvec4(point, 1.0));
}

double scaleOf(const glm::dmat4& placement) {
    return std::cbrt(std::abs(glm::determinant(glm::dmat3(placement))));
}

// Not finite for a direction of length 0, which isValid() refuses.
vec3 unitVector(const glm::dvec3& v) {
    return vec3(v / glm::length(v));
}

void store(const glm::dvec3& from, double (&to)[3]) {
    for (int i = 0; i < 3; ++i) to[i] = from[i];
}

glm::dvec3 load(const double (&from)[3]) {
    return {from[0], from[1], from[2]};
}

} // namespace

void setRectangle(const glm::dvec3& toEdgeU, const glm::dvec3& toEdgeV, const glm::dvec3& facing,
                  const glm::dmat3& linear, Light& light) {
    const glm::dvec3 u = linear * toEdgeU;
    const glm::dvec3 skewed = linear * toEdgeV;
    const glm::dvec3 v = skewed - u * (glm::dot(skewed, u) / glm::dot(u, u));
    const glm::dvec3 across = glm::cross(u, v);
    light.direction = vec4(unitVector(glm::dot(across, linear * facing) < 0.0 ? -across : across), 0.0f);
    light.edgeU = vec4(vec3(u), 0.0f);
    light.edgeV = vec4(vec3(v), 0.0f);
}

Light placed(const Light& light, const glm::dmat4& placement) {
    const glm::dmat3 linear(placement);
    const double scale = scaleOf(placement);
    const std::uint32_t kind = light.kind.x;
    Light result = light;
    if (kind != kLightDirectional)
        result.position = vec4(vec3(pointUnder(placement, glm::dvec3(light.position))),
                               static_cast<float>(light.position.w * scale));
    if (kind == kLightPoint || kind == kLightSpot)
        result.intensity = vec4(vec3(glm::dvec3(light.intensity) * (scale * scale)), 0.0f);
    if (kind == kLightDirectional || kind == kLightSpot)
        result.direction = vec4(unitVector(linear * glm::dvec3(light.direction)), light.direction.w);
    if (kind == kLightRectangle)
        setRectangle(glm::dvec3(light.edgeU), glm::dvec3(light.edgeV), glm::dvec3(light.direction), linear,
                     result);
    return result;
}

NamedCamera placed(const NamedCamera& camera, const glm::dmat4& placement) {
    const double scale = scaleOf(placement);
    NamedCamera result = camera;
    store(pointUnder(placement, load(camera.eye)), result.eye);
    store(pointUnder(placement, load(camera.lookAt)), result.lookAt);
    store(glm::dmat3(placement) * load(camera.up), result.up);
    result.height *= scale;
    result.lensRadius *= scale;
    result.focusDistance *= scale;
    return result;
}

CameraKey placed(const CameraKey& key, const glm::dmat4& placement) {
    CameraKey result = key;
    result.eye = pointUnder(placement, key.eye);
    result.lookAt = pointUnder(placement, key.lookAt);
    result.up = glm::dmat3(placement) * key.up;
    return result;
}

} // namespace rt

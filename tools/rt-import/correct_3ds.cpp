#include "tools/rt-import/correct_3ds.h"

#include "tools/rt-import/assimp_glm.h"

#include <assimp/camera.h>
#include <assimp/scene.h>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include <cmath>
#include <span>

namespace rt {
namespace {

constexpr double kHalfFilmWidth = 18.0; // mm

glm::dvec3 across(const glm::dvec3& v, const glm::dvec3& unitAxis) {
    return v - unitAxis * glm::dot(v, unitAxis);
}

// The angle about the view by which +y was turned to `rolledY`; 0 for a view along y, which hides it.
double rollOf(const glm::dvec3& rolledY, const glm::dvec3& view) {
    const glm::dvec3 from = across({0, 1, 0}, view), to = across(rolledY, view);
    return std::atan2(glm::dot(glm::cross(from, to), view), glm::dot(from, to));
}

} // namespace

void correct3dsCameras(aiScene& scene) {
    for (aiCamera* camera : std::span(scene.mCameras, scene.mNumCameras)) {
        const double lens = glm::degrees(static_cast<double>(camera->mHorizontalFOV));
        camera->mHorizontalFOV = static_cast<float>(2.0 * std::atan(kHalfFilmWidth / lens));
        const glm::dvec3 view = glm::normalize(glm::dvec3(vec3Of(camera->mLookAt)));
        const double roll = rollOf(glm::dvec3(vec3Of(camera->mUp)), view);
        const glm::dvec3 straight = across({0, 0, 1}, view);
        if (!(glm::length(straight) > 1e-6)) continue; // straight up or down: +y is as good
        const glm::dvec3 up = straight * std::cos(roll) + glm::cross(view, straight) * std::sin(roll);
        camera->mUp =
            aiVector3D(static_cast<float>(up.x), static_cast<float>(up.y), static_cast<float>(up.z));
    }
}

} // namespace rt

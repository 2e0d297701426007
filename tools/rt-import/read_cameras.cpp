#include "tools/rt-import/read_cameras.h"

#include "tools/rt-import/assimp_glm.h"

#include <assimp/camera.h>
#include <assimp/scene.h>
#include <fmt/format.h>
#include <glm/trigonometric.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace rt {
namespace {

constexpr std::size_t kMaxNameBytes = sizeof(NamedCamera::name) - 1;

// At most `bytes` of it, none of its UTF-8 characters cut.
std::string clip(const std::string& text, std::size_t bytes) {
    if (text.size() <= bytes) return text;
    while (bytes > 0 && (static_cast<unsigned char>(text[bytes]) & 0xC0u) == 0x80u) --bytes;
    return text.substr(0, bytes);
}

void setName(const char* given, NamedCamera& camera) {
    std::string name = *given ? given : "camera";
    std::replace_if(
        name.begin(), name.end(), [](char c) { return static_cast<unsigned char>(c) < 32; }, '_');
    clip(name, kMaxNameBytes).copy(camera.name, kMaxNameBytes);
}

void store(const glm::dvec3& from, double (&to)[3]) {
    for (int i = 0; i < 3; ++i) to[i] = from[i];
}

double heightAngle(double angle, double ratio, SceneryStyle style) {
    return style == SceneryStyle::Gltf ? angle / ratio : 2.0 * std::atan(std::tan(0.5 * angle) / ratio);
}

void setView(const aiCamera& source, SceneryStyle style, NamedCamera& camera) {
    const double ratio = source.mAspect > 0.0f ? static_cast<double>(source.mAspect) : 1.0;
    if (source.mOrthographicWidth != 0.0f) {
        camera.kind = kCameraOrthographic;
        camera.height = 2.0 * std::abs(static_cast<double>(source.mOrthographicWidth)) / ratio;
    } else {
        camera.kind = kCameraPerspective;
        camera.fovDegrees =
            glm::degrees(heightAngle(static_cast<double>(source.mHorizontalFOV), ratio, style));
    }
}

NamedCamera readCamera(const aiCamera& source, const aiNode* node, const aiNode* owner, SceneryStyle style) {
    const glm::dmat3 linear(worldFromNode(node));
    const glm::dvec3 eye = worldPosition(node, owner, glm::dvec3(vec3Of(source.mPosition)));
    const glm::dvec3 forward = glm::normalize(linear * glm::dvec3(vec3Of(source.mLookAt)));
    glm::dvec3 up = glm::normalize(linear * glm::dvec3(vec3Of(source.mUp)));
    if (!(glm::length(glm::cross(forward, up)) > 1e-6)) // any other will do
        up = std::abs(forward.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(0, 0, 1);
    NamedCamera camera{};
    store(eye, camera.eye);
    store(eye + forward, camera.lookAt);
    store(up, camera.up);
    setView(source, style, camera);
    return camera;
}

} // namespace

std::vector<NamedCamera> readCameras(const aiScene& scene, const NodesByName& nodes, SceneryStyle style,
                                     std::vector<std::string>& warnings) {
    std::vector<NamedCamera> cameras;
    unsigned broken = 0;
    for (unsigned i = 0; i < scene.mNumCameras; ++i) {
        const aiCamera& source = *scene.mCameras[i];
        const aiNode* owner = scene.mRootNode->FindNode(source.mName);
        for (const aiNode* node : nodesOf(source.mName.C_Str(), nodes, scene.mRootNode)) {
            NamedCamera camera = readCamera(source, node, owner, style);
            setName((node ? node->mName : source.mName).C_Str(), camera);
            const bool valid = isValid(camera);
            if (valid) cameras.push_back(camera);
            broken += !valid;
        }
    }
    if (broken > 0)
        warnings.push_back(fmt::format("{} cameras are not finite or show nothing and are left out", broken));
    return cameras;
}

void makeNamesUnique(std::vector<NamedCamera>& cameras) {
    std::set<std::string> names;
    std::map<std::string, unsigned> lastNumbers; // so that many of one name do not all count from 1
    for (NamedCamera& camera : cameras) {
        const std::string name = camera.name;
        std::string result = name;
        while (!names.insert(result).second) {
            const std::string number = fmt::format(".{}", ++lastNumbers[name]);
            result = clip(name, kMaxNameBytes - number.size()) + number;
        }
        std::fill(std::begin(camera.name), std::end(camera.name), '\0');
        result.copy(camera.name, kMaxNameBytes);
    }
}

} // namespace rt

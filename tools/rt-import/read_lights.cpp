#include "tools/rt-import/read_lights.h"

#include "formats/mesh.h"

#include "tools/rt-import/assimp_glm.h"

#include <assimp/light.h>
#include <assimp/scene.h>
#include <fmt/format.h>
#include <glm/gtc/constants.hpp>

#include <cmath>

namespace rt {
namespace {

glm::dmat4 worldFromNode(const aiNode* node) {
    glm::dmat4 world(1.0);
    for (; node; node = node->mParent) world = mat4Of(node->mTransformation) * world;
    return world;
}

bool isFinite(const glm::dvec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

bool fallsOff(const aiLight& light) {
    return light.mAttenuationLinear != 0.0f || light.mAttenuationQuadratic != 0.0f;
}

Light readPointLight(const aiLight& light, const aiNode* root, const glm::vec3& sceneCentre) {
    const glm::dmat4 world = worldFromNode(root->FindNode(light.mName));
    const glm::dvec3 position(world * glm::dvec4(vec3Of(light.mPosition), 1.0));
    const glm::dvec3 color(light.mColorDiffuse.r, light.mColorDiffuse.g, light.mColorDiffuse.b);
    const glm::dvec3 toCentre = glm::dvec3(sceneCentre) - position;
    // Our lights give intensity / (pi d^2); this makes it the colour itself at the centre.
    const double scale = fallsOff(light) ? 1.0 : glm::pi<double>() * glm::dot(toCentre, toCentre);
    return pointLight(glm::vec3(position), glm::vec3(glm::max(color * scale, 0.0)));
}

} // namespace

std::vector<Light> readPointLights(const aiScene& scene, const glm::vec3& sceneCentre,
                                   std::vector<std::string>& warnings) {
    std::vector<Light> lights;
    unsigned otherKinds = 0, constant = 0, broken = 0;
    for (unsigned i = 0; i < scene.mNumLights; ++i) {
        const aiLight& source = *scene.mLights[i];
        if (source.mType != aiLightSource_POINT) {
            ++otherKinds;
            continue;
        }
        const Light light = readPointLight(source, scene.mRootNode, sceneCentre);
        const bool finite = isFinite(glm::dvec3(light.position)) && isFinite(glm::dvec3(light.intensity));
        if (finite) lights.push_back(light);
        broken += !finite;
        constant += finite && !fallsOff(source);
    }
    if (otherKinds > 0)
        warnings.push_back(fmt::format("{} lights are no point lights and are left out", otherKinds));
    if (broken > 0) warnings.push_back(fmt::format("{} lights are not finite and are left out", broken));
    if (constant > 0)
        warnings.push_back(
            fmt::format("{} lights have no fall-off in the file; they get one that keeps their "
                        "brightness at the scene's centre",
                        constant));
    return lights;
}

} // namespace rt

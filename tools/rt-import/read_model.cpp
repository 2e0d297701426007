#include "tools/rt-import/read_model.h"

#include "common/stage_timer.h"
#include "tools/rt-import/assimp_glm.h"
#include "tools/rt-import/import_model.h"
#include "tools/rt-import/model_folder.h"
#include "tools/rt-import/open_model.h"
#include "tools/rt-import/place_scenery.h"
#include "tools/rt-import/read_cameras.h"
#include "tools/rt-import/read_gltf_extras.h"
#include "tools/rt-import/read_lights.h"

#include <assimp/scene.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

namespace rt {
namespace {

void addFace(const aiFace& face, const MeshInstance& instance, Bounds& bounds) {
    for (unsigned corner = 0; corner < face.mNumIndices; ++corner) {
        if (face.mIndices[corner] >= instance.mesh->mNumVertices) continue;
        const glm::dvec3 vertex(vec3Of(instance.mesh->mVertices[face.mIndices[corner]]));
        const glm::vec3 position(instance.worldFromMesh * glm::dvec4(vertex, 1.0));
        if (std::isfinite(position.x + position.y + position.z)) bounds.add(position);
    }
}

// Of the triangles' bounds, in the model's own space; the origin where there are none.
glm::vec3 centreOf(const aiScene& scene) {
    Bounds bounds;
    for (const MeshInstance& instance : listInstances(scene, {glm::dmat4(1.0)}))
        for (unsigned f = 0; f < instance.mesh->mNumFaces; ++f)
            if (instance.mesh->mFaces[f].mNumIndices == 3)
                addFace(instance.mesh->mFaces[f], instance, bounds);
    return bounds.lo.x <= bounds.hi.x ? bounds.centre() : glm::vec3(0.0f);
}

// A facet of an STL file states its own plane's normal, which would hide the surface's smoothness.
bool hasOwnNormals(const std::string& path) {
    return lowerExtension(path) != "stl";
}

SceneryStyle styleOf(const std::string& path) {
    const std::string extension = lowerExtension(path);
    return extension == "gltf" || extension == "glb" ? SceneryStyle::Gltf : SceneryStyle::Classic;
}

// The materials that triangles use, and what they want of the vertices.
struct UsedMaterials {
    std::vector<MaterialSource> sources;
    std::vector<std::uint32_t> slotOf; // of each of the scene's materials: index into `sources`
    SoupOptions wanted;
};

UsedMaterials readMaterials(const aiScene& scene, const std::vector<bool>& used, const GltfExtras& extras,
                            const PlacedModel& model, Overrides& overrides,
                            std::vector<std::string>& warnings) {
    UsedMaterials materials;
    materials.slotOf.assign(used.size(), 0);
    SoupOptions& wanted = materials.wanted;
    wanted.uvChannel.assign(used.size(), 0);
    wanted.uvTransform.assign(used.size(), TextureSource::kNoTransform);
    for (unsigned m = 0; m < scene.mNumMaterials; ++m) {
        if (!used[m]) continue;
        materials.slotOf[m] = static_cast<std::uint32_t>(materials.sources.size());
        const auto extra = extras.materials.find(m);
        materials.sources.push_back(
            readMaterial(*scene.mMaterials[m],
                         extra == extras.materials.end() ? GltfMaterialExtras{} : extra->second, warnings));
        overrides.apply(model.overrides, materials.sources.back());
        for (const auto& texture : materials.sources.back().textures) {
            if (!texture) continue;
            wanted.uvChannel[m] = texture->uvChannel; // all of them use the same
            wanted.uvTransform[m] = texture->uvTransform;
        }
    }
    return materials;
}

// Assimp adds materials of its own, without a name or with this one.
std::uint64_t countUnusedMaterials(const aiScene& scene, const std::vector<bool>& used) {
    std::uint64_t count = 0;
    for (unsigned m = 0; m < scene.mNumMaterials; ++m) {
        const std::string name = scene.mMaterials[m]->GetName().C_Str();
        count += !used[m] && !name.empty() && name != AI_DEFAULT_MATERIAL_NAME;
    }
    return count;
}

// Each of them at each of the model's places.
template <class Thing>
void placeAll(const std::vector<Thing>& things, const PlacedModel& model, const char* name,
              std::vector<Thing>& result, std::vector<std::string>& warnings) {
    std::size_t broken = 0;
    for (const Thing& thing : things)
        for (const glm::dmat4& placement : model.placements) {
            const Thing moved = placed(thing, placement);
            if (isValid(moved)) result.push_back(moved);
            broken += !isValid(moved);
        }
    if (broken > 0)
        warnings.push_back(
            fmt::format("{} {} are out of range where they are placed and are left out", broken, name));
}

// Models may leave out the same kind of thing.
void addLeftOut(const LeftOut& more, std::vector<LeftOut>& leftOut) {
    const auto same = [&](const LeftOut& other) { return std::string_view(other.what) == more.what; };
    const auto known = std::find_if(leftOut.begin(), leftOut.end(), same);
    if (known == leftOut.end()) {
        leftOut.push_back(more);
        return;
    }
    known->count += more.count;
    known->bytes += more.bytes;
}

} // namespace

void Overrides::apply(const std::vector<std::uint32_t>& indices, MaterialSource& material) {
    for (const std::uint32_t index : indices) {
        if (!matches(all[index].pattern, material.name)) continue;
        applyOverride(all[index], material);
        matched[index] = true;
    }
}

SceneParts readModel(const PlacedModel& model, const ImportSettings& settings, Overrides& overrides,
                     const ModelFolder& folder, ImportReport& report, std::vector<std::string>& warnings,
                     StageTimer& timer) {
    timer.begin("read");
    const OpenModel opened(model.path, settings, folder, warnings);
    const aiScene& scene = opened.scene();
    const std::vector<MeshInstance> instances = listInstances(scene, model.placements);
    warnOfLost(scene, warnings);

    timer.begin("materials");
    SceneParts parts;
    const GltfExtras extras = readGltfExtras(model.path, scene, warnings);
    const std::vector<bool> used = findUsedMaterials(scene, instances, model.path);
    UsedMaterials materials = readMaterials(scene, used, extras, model, overrides, warnings);
    parts.images = loadImages(scene, materials.sources, folder, warnings);
    materials.wanted.texcoords = !parts.images.images.empty();
    materials.wanted.normals = hasOwnNormals(model.path);
    for (const MaterialSource& source : materials.sources) parts.materials.push_back(source.material);
    parts.unusedMaterials = countUnusedMaterials(scene, used);
    addLeftOut(countUnusedTextures(scene, materials.sources), report.leftOut);
    addLeftOut(countUnusedTexcoords(instances, materials.wanted), report.leftOut);

    timer.begin("soup");
    parts.soup = readSoup(opened, instances, materials.wanted, model.path, report.ledger);
    for (std::uint32_t& material : parts.soup.triangleMaterial) material = materials.slotOf[material];
    const SceneryStyle style = styleOf(model.path);
    if (model.lights && scene.mNumLights > 0)
        placeAll(readLights(scene, extras.lightNodes, centreOf(scene), style, warnings), model, "lights",
                 parts.lights, warnings);
    if (model.cameras)
        placeAll(readCameras(scene, extras.cameraNodes, style, warnings), model, "cameras", parts.cameras,
                 warnings);
    return parts;
}

} // namespace rt

#include "tools/rt-import/import_model.h"

#include "common/error.h"
#include "common/stage_timer.h"
#include "tools/rt-import/assimp_glm.h"
#include "tools/rt-import/load_images.h"
#include "tools/rt-import/model_folder.h"
#include "tools/rt-import/open_model.h"
#include "tools/rt-import/place_scenery.h"
#include "tools/rt-import/read_cameras.h"
#include "tools/rt-import/read_gltf_extras.h"
#include "tools/rt-import/read_lights.h"
#include "tools/rt-import/read_scene.h"
#include "tools/rt-import/repair_mesh.h"
#include "tools/rt-import/scene_description.h"
#include "tools/rt-import/scene_parts.h"
#include "tools/rt-import/weld_vertices.h"

#include <assimp/scene.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

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

// The overrides of a scene, and which of them changed something.
struct Overrides {
    const std::vector<MaterialOverride>& all;
    std::vector<bool> matched;

    void apply(const std::vector<std::uint32_t>& indices, MaterialSource& material) {
        for (const std::uint32_t index : indices) {
            if (!matches(all[index].pattern, material.name)) continue;
            applyOverride(all[index], material);
            matched[index] = true;
        }
    }
};

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

SceneParts readParts(const PlacedModel& model, Overrides& overrides, ModelFolder& folder,
                     std::vector<std::string>& warnings, StageTimer& timer) {
    timer.begin("read");
    const OpenModel opened(model.path, folder, warnings);
    const aiScene& scene = opened.scene();
    const std::vector<MeshInstance> instances = listInstances(scene, model.placements);

    timer.begin("materials");
    SceneParts parts;
    const GltfExtras extras = readGltfExtras(model.path, scene, warnings);
    const std::vector<bool> used = findUsedMaterials(scene, instances, model.path);
    UsedMaterials materials = readMaterials(scene, used, extras, model, overrides, warnings);
    parts.images = loadImages(scene, materials.sources, folder, warnings);
    materials.wanted.texcoords = !parts.images.images.empty();
    materials.wanted.normals = hasOwnNormals(model.path);
    for (const MaterialSource& source : materials.sources) parts.materials.push_back(source.material);

    timer.begin("soup");
    parts.soup = readSoup(scene, instances, materials.wanted, model.path);
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

void addOnce(const std::vector<std::string>& more, std::vector<std::string>& names) {
    for (const std::string& name : more)
        if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
}

// All models, one after the other. Warnings name the model where there are several.
SceneParts readModels(const SceneDescription& scene, ImportedModel& result, StageTimer& timer) {
    const bool several = scene.models.size() > 1 || !scene.filesRead.empty();
    std::vector<std::string>& warnings = result.report.warnings;
    Overrides overrides{scene.overrides, std::vector<bool>(scene.overrides.size())};
    SceneParts whole;
    for (const PlacedModel& model : scene.models) {
        ModelFolder folder(model.path, model.folders);
        std::vector<std::string> own;
        append(readParts(model, overrides, folder, own, timer), whole, model.path);
        for (const std::string& warning : own)
            warnings.push_back(several ? model.path + ": " + warning : warning);
        addOnce(folder.filesRead(), result.filesRead);
    }
    for (std::size_t i = 0; i < scene.overrides.size(); ++i)
        if (!overrides.matched[i])
            warnings.push_back(fmt::format("{}: no material is called '{}'", scene.overrides[i].place,
                                           scene.overrides[i].pattern));
    return whole;
}

void addDescribed(SceneDescription& scene, const SceneParts& parts, Mesh& mesh) {
    std::vector<Light> lights = parts.lights;
    lights.insert(lights.end(), scene.lights.begin(), scene.lights.end());
    std::vector<NamedCamera> cameras = parts.cameras;
    std::vector<CameraKey> keys;
    for (const DescribedCamera& described : scene.cameras) {
        for (CameraKey key : described.path) {
            key.camera = static_cast<std::uint32_t>(cameras.size());
            keys.push_back(key);
        }
        cameras.push_back(described.camera);
    }
    makeNamesUnique(cameras);
    mesh.lights = std::move(lights);
    mesh.cameras = std::move(cameras);
    mesh.cameraKeys = std::move(keys);
    if (scene.surroundings.hasBackground || scene.hasEnvironment)
        mesh.surroundings = std::vector<Surroundings>{scene.surroundings};
    mesh.environment = std::move(scene.environment.pixels);
}

} // namespace

ImportedModel importScene(const SceneSources& sources, double creaseDegrees, StageTimer& timer) {
    ImportedModel result;
    timer.begin("describe");
    SceneDescription scene = describeScene(sources.inputs, sources.roots);
    result.report.warnings = scene.warnings;
    addOnce(scene.filesRead, result.filesRead);
    SceneParts parts = readModels(scene, result, timer);
    const std::string name = fmt::format("{}", fmt::join(sources.inputs, ", "));
    if (parts.soup.triangles.empty())
        throw Error(ErrorKind::InvalidContent, name + ": has no triangles; nothing could be seen");
    if (scene.models.size() > 1)
        requireFiniteWorld(parts.soup, name); // each of them is, but are they together?
    result.report.droppedFaces = parts.soup.droppedFaces;

    timer.begin("repair");
    const Weld weld = weldPositions(parts.soup);
    result.report.weldedVertices = weld.positions.size();
    result.report.generatedNormals = countMissingNormals(parts.soup);
    const RepairedSurface surface =
        repairSurface(weld.positions, weld.triangles, creaseDegrees, result.report.generatedNormals > 0);
    result.report.degenerateTriangles = surface.degenerateTriangles;
    result.report.nonManifoldFaces = surface.nonManifoldFaces;

    timer.begin("merge");
    Mesh& mesh = result.mesh;
    mesh = mergeCorners(parts.soup, weld, surface.cornerNormals);
    mesh.triangleMaterial = std::move(parts.soup.triangleMaterial);
    mesh.materials = std::move(parts.materials);
    mesh.images = std::move(parts.images.images);
    mesh.pixels = std::move(parts.images.pixels);
    addDescribed(scene, parts, mesh);
    validate(mesh, name);
    timer.end();
    return result;
}

ImportedModel importModel(const std::string& path, double creaseDegrees, StageTimer& timer) {
    return importScene({{path}, {}}, creaseDegrees, timer);
}

} // namespace rt

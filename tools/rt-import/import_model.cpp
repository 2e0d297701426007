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

namespace rt {
namespace {

// Of the model's own space.
Bounds boundsOf(const aiScene& scene) {
    Bounds bounds;
    for (const MeshInstance& instance : listInstances(scene, {glm::dmat4(1.0)}))
        for (unsigned v = 0; v < instance.mesh->mNumVertices; ++v)
            bounds.add(
                glm::vec3(instance.worldFromMesh * glm::dvec4(vec3Of(instance.mesh->mVertices[v]), 1.0)));
    return bounds;
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
    std::vector<MaterialOverride> all;
    std::vector<bool> matched;

    void apply(const std::vector<std::uint32_t>& indices, MaterialSource& material) {
        for (const std::uint32_t index : indices) {
            if (!matches(all[index].pattern, material.name)) continue;
            applyOverride(all[index], material);
            matched[index] = true;
        }
    }
};

class SceneReader {
public:
    SceneReader(const SceneDescription& scene, ImportReport& report, StageTimer& timer)
        : overrides_{scene.overrides, std::vector<bool>(scene.overrides.size())}, report_(report),
          timer_(timer), namesModels_(scene.models.size() > 1 || !scene.filesRead.empty()) {}

    void add(const PlacedModel& model) {
        ModelFolder folder(model.path, model.folders);
        std::vector<std::string> warnings;
        append(readParts(model, folder, warnings), whole, model.path);
        for (const std::string& warning : warnings)
            report_.warnings.push_back(namesModels_ ? model.path + ": " + warning : warning);
        for (const std::string& file : folder.filesRead())
            if (std::find(filesRead.begin(), filesRead.end(), file) == filesRead.end())
                filesRead.push_back(file);
    }

    void warnOfUnusedOverrides() {
        for (std::size_t i = 0; i < overrides_.all.size(); ++i)
            if (!overrides_.matched[i])
                report_.warnings.push_back(fmt::format("{}: no material is called '{}'",
                                                       overrides_.all[i].place, overrides_.all[i].pattern));
    }

    SceneParts whole;
    std::vector<std::string> filesRead;

private:
    SceneParts readParts(const PlacedModel& model, ModelFolder& folder, std::vector<std::string>& warnings) {
        timer_.begin("read");
        const OpenModel opened(model.path, folder, warnings);
        const aiScene& scene = opened.scene();
        const std::vector<MeshInstance> instances = listInstances(scene, model.placements);

        timer_.begin("materials");
        SceneParts parts;
        std::vector<std::uint32_t> slotOf;
        const GltfExtras extras = readGltfExtras(model.path, scene, warnings);
        const std::vector<bool> used = findUsedMaterials(scene, instances, model.path);
        SoupOptions wanted = readMaterials(scene, used, extras, model, folder, warnings, parts, slotOf);
        wanted.normals = hasOwnNormals(model.path);

        timer_.begin("soup");
        parts.soup = readSoup(scene, instances, wanted, model.path);
        for (std::uint32_t& material : parts.soup.triangleMaterial) material = slotOf[material];
        if (model.lights) addLights(scene, extras, model, parts, warnings);
        if (model.cameras)
            for (const NamedCamera& camera :
                 readCameras(scene, extras.cameraNodes, styleOf(model.path), warnings))
                for (const glm::dmat4& placement : model.placements)
                    parts.cameras.push_back(placed(camera, placement));
        return parts;
    }

    // Fills `parts` with the materials that triangles use and their images, and `slotOf` with the numbers
    // that the scene's materials have there. What they want of the vertices is returned.
    SoupOptions readMaterials(const aiScene& scene, const std::vector<bool>& used, const GltfExtras& extras,
                              const PlacedModel& model, ModelFolder& folder,
                              std::vector<std::string>& warnings, SceneParts& parts,
                              std::vector<std::uint32_t>& slotOf) {
        SoupOptions wanted;
        wanted.uvChannel.assign(used.size(), 0);
        wanted.uvTransform.assign(used.size(), TextureSource::kNoTransform);
        slotOf.assign(used.size(), 0);
        std::vector<MaterialSource> sources;
        for (unsigned m = 0; m < scene.mNumMaterials; ++m) {
            if (!used[m]) continue;
            slotOf[m] = static_cast<std::uint32_t>(sources.size());
            const auto extra = extras.materials.find(m);
            sources.push_back(readMaterial(
                *scene.mMaterials[m], extra == extras.materials.end() ? GltfMaterialExtras{} : extra->second,
                warnings));
            overrides_.apply(model.overrides, sources.back());
            for (const auto& texture : sources.back().textures) {
                if (!texture) continue;
                wanted.uvChannel[m] = texture->uvChannel; // all of them use the same
                wanted.uvTransform[m] = texture->uvTransform;
            }
        }
        parts.images = loadImages(scene, sources, folder, warnings);
        wanted.texcoords = !parts.images.images.empty();
        for (const MaterialSource& source : sources) parts.materials.push_back(source.material);
        return wanted;
    }

    void addLights(const aiScene& scene, const GltfExtras& extras, const PlacedModel& model,
                   SceneParts& parts, std::vector<std::string>& warnings) {
        if (scene.mNumLights == 0) return;
        for (const Light& light :
             readLights(scene, extras.lightNodes, boundsOf(scene).centre(), styleOf(model.path), warnings))
            for (const glm::dmat4& placement : model.placements)
                parts.lights.push_back(placed(light, placement));
    }

    Overrides overrides_;
    ImportReport& report_;
    StageTimer& timer_;
    bool namesModels_; // in warnings
};

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
    SceneReader reader(scene, result.report, timer);
    for (const PlacedModel& model : scene.models) reader.add(model);
    reader.warnOfUnusedOverrides();
    SceneParts& parts = reader.whole;
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
    result.filesRead = std::move(scene.filesRead);
    result.filesRead.insert(result.filesRead.end(), reader.filesRead.begin(), reader.filesRead.end());
    return result;
}

ImportedModel importModel(const std::string& path, double creaseDegrees, StageTimer& timer) {
    return importScene({{path}, {}}, creaseDegrees, timer);
}

} // namespace rt

#include "tools/rt-import/import_model.h"

#include "common/stage_timer.h"
#include "tools/rt-import/load_images.h"
#include "tools/rt-import/model_folder.h"
#include "tools/rt-import/open_model.h"
#include "tools/rt-import/read_cameras.h"
#include "tools/rt-import/read_gltf_extras.h"
#include "tools/rt-import/read_lights.h"
#include "tools/rt-import/read_scene.h"
#include "tools/rt-import/repair_mesh.h"
#include "tools/rt-import/weld_vertices.h"

#include <assimp/scene.h>

namespace rt {
namespace {

// All that is taken from the file, so that the library's own copy of it can be freed before the mesh is
// built.
struct SceneParts {
    SceneSoup soup;
    std::vector<Material> materials;
    std::vector<std::uint32_t> slotOf; // of each of the scene's materials: index into `materials`
    LoadedImages images;
    std::vector<Light> lights;
    std::vector<NamedCamera> cameras;
};

Bounds boundsOf(const SceneSoup& soup) {
    Bounds bounds;
    for (const glm::vec3& position : soup.positions) bounds.add(position);
    return bounds;
}

// A facet of an STL file states its own plane's normal, which would hide the surface's smoothness.
bool hasOwnNormals(const std::string& path) {
    return lowerExtension(path) != "stl";
}

SpotAngles spotAnglesOf(const std::string& path) {
    return lowerExtension(path) == "3ds" ? SpotAngles::AcrossCone : SpotAngles::FromAxis;
}

// Fills `parts` with the materials that triangles use and their images. What they want of the vertices is
// returned.
SoupOptions readMaterials(const aiScene& scene, const std::vector<bool>& used, const GltfExtras& extras,
                          ModelFolder& folder, std::vector<std::string>& warnings, SceneParts& parts) {
    SoupOptions wanted;
    wanted.uvChannel.assign(used.size(), 0);
    wanted.uvTransform.assign(used.size(), TextureSource::kNoTransform);
    parts.slotOf.assign(used.size(), 0);
    std::vector<MaterialSource> sources;
    for (unsigned m = 0; m < scene.mNumMaterials; ++m) {
        if (!used[m]) continue;
        parts.slotOf[m] = static_cast<std::uint32_t>(sources.size());
        const auto extra = extras.materials.find(m);
        sources.push_back(readMaterial(*scene.mMaterials[m],
                                       extra == extras.materials.end() ? GltfMaterialExtras{} : extra->second,
                                       warnings));
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

SceneParts readParts(const std::string& path, ModelFolder& folder, ImportReport& report, StageTimer& timer) {
    timer.begin("read");
    const OpenModel model(path, folder, report.warnings);
    const aiScene& scene = model.scene();
    const std::vector<MeshInstance> instances = listInstances(scene);

    timer.begin("materials");
    SceneParts parts;
    const GltfExtras extras = readGltfExtras(path, scene, report.warnings);
    const std::vector<bool> used = findUsedMaterials(scene, instances, path);
    SoupOptions wanted = readMaterials(scene, used, extras, folder, report.warnings, parts);
    wanted.normals = hasOwnNormals(path);

    timer.begin("soup");
    parts.soup = readSoup(scene, instances, wanted, path);
    parts.lights = readLights(scene, extras.lightNodes, boundsOf(parts.soup).centre(), spotAnglesOf(path),
                              report.warnings);
    parts.cameras = readCameras(scene, extras.cameraNodes, report.warnings);
    report.droppedFaces = parts.soup.droppedFaces;
    return parts;
}

} // namespace

ImportedModel importModel(const std::string& path, double creaseDegrees, StageTimer& timer) {
    ImportedModel result;
    ModelFolder folder(path);
    SceneParts parts = readParts(path, folder, result.report, timer);

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
    for (std::uint32_t& material : parts.soup.triangleMaterial) material = parts.slotOf[material];
    mesh.triangleMaterial = std::move(parts.soup.triangleMaterial);
    mesh.materials = std::move(parts.materials);
    mesh.lights = std::move(parts.lights);
    mesh.cameras = std::move(parts.cameras);
    mesh.images = std::move(parts.images.images);
    mesh.pixels = std::move(parts.images.pixels);
    validate(mesh, path);
    timer.end();
    result.filesRead = folder.filesRead();
    return result;
}

} // namespace rt

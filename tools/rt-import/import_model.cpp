#include "tools/rt-import/import_model.h"

#include "common/error.h"
#include "common/stage_timer.h"
#include "tools/rt-import/load_images.h"
#include "tools/rt-import/model_folder.h"
#include "tools/rt-import/open_model.h"
#include "tools/rt-import/read_cameras.h"
#include "tools/rt-import/read_gltf_extras.h"
#include "tools/rt-import/read_lights.h"
#include "tools/rt-import/read_scene.h"
#include "tools/rt-import/skip_unneeded.h"

#include <assimp/scene.h>
#include <fmt/format.h>

#include <map>

namespace rt {
namespace {

// All that is taken from the file, so that the library's own copy of it can be freed before the mesh is
// built.
struct SceneParts {
    SceneSoup soup;
    std::vector<Material> materials; // which the soup's triangles name by their place here
    std::uint64_t unusedMaterials = 0;
    LoadedImages images;
    std::vector<Light> lights;
    std::vector<NamedCamera> cameras;
};

Bounds boundsOf(const SceneSoup& soup) {
    Bounds bounds;
    for (const glm::uvec3& t : soup.triangles)
        for (int corner = 0; corner < 3; ++corner) bounds.add(soup.positions[t[corner]]);
    return bounds;
}

// A facet of an STL file states its own plane's normal, which would hide the surface's smoothness.
bool hasOwnNormals(const std::string& path) {
    return lowerExtension(path) != "stl";
}

SpotAngles spotAnglesOf(const std::string& path) {
    return lowerExtension(path) == "3ds" ? SpotAngles::AcrossCone : SpotAngles::FromAxis;
}

// The materials that triangles use, and what they want of the vertices.
struct UsedMaterials {
    std::vector<MaterialSource> sources;
    std::vector<std::uint32_t> slotOf; // of each of the scene's materials: index into `sources`
    SoupOptions wanted;
};

UsedMaterials readMaterials(const aiScene& scene, const std::vector<bool>& used, const GltfExtras& extras,
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

SceneParts readParts(const std::string& path, const ImportSettings& settings, ModelFolder& folder,
                     ImportReport& report, StageTimer& timer) {
    constexpr double kReadingShare = 0.5; // of the time, about
    timer.begin("read");
    const OpenModel model(path, settings.allowedFormats, folder, report.warnings,
                          [&](double part) { settings.progress(kReadingShare * part); });
    const aiScene& scene = model.scene();
    const std::vector<MeshInstance> instances = listInstances(scene);
    warnOfLost(scene, report.warnings);

    timer.begin("materials");
    SceneParts parts;
    const GltfExtras extras = readGltfExtras(path, scene, report.warnings);
    const std::vector<bool> used = findUsedMaterials(scene, instances, path);
    UsedMaterials materials = readMaterials(scene, used, extras, report.warnings);
    parts.images = loadImages(scene, materials.sources, folder, report.warnings);
    materials.wanted.texcoords = !parts.images.images.empty();
    materials.wanted.normals = hasOwnNormals(path);
    for (const MaterialSource& source : materials.sources) parts.materials.push_back(source.material);
    parts.unusedMaterials = countUnusedMaterials(scene, used);
    report.leftOut.push_back(countUnusedTextures(scene, materials.sources));
    report.leftOut.push_back(countUnusedTexcoords(instances, materials.wanted));

    timer.begin("soup");
    parts.soup = readSoup(model, instances, materials.wanted, path, report.ledger);
    requireTriangles(parts.soup, path, report.ledger);
    for (std::uint32_t& material : parts.soup.triangleMaterial) material = materials.slotOf[material];
    parts.lights = readLights(scene, extras.lightNodes, boundsOf(parts.soup).centre(), spotAnglesOf(path),
                              report.warnings);
    parts.cameras = readCameras(scene, extras.cameraNodes, report.warnings);
    return parts;
}

void skipUnneeded(SceneParts& parts, std::vector<LeftOut>& leftOut) {
    leftOut.push_back(countUnusedVertices(parts.soup));
    const std::uint64_t unused =
        parts.unusedMaterials + dropUnusedMaterials(parts.soup.triangleMaterial, parts.materials);
    leftOut.push_back({"unusedMaterials", unused, unused * sizeof(Material)});
    leftOut.push_back(dropUnusedImages(parts.materials, parts.images));
}

// 1500 materials may miss the same texture.
void countRepeats(std::vector<std::string>& warnings) {
    std::vector<std::string> distinct;
    std::map<std::string, unsigned> counts;
    for (std::string& warning : warnings)
        if (counts[warning]++ == 0) distinct.push_back(std::move(warning));
    for (std::string& warning : distinct)
        if (const unsigned count = counts[warning]; count > 1) warning += fmt::format(" ({} times)", count);
    warnings = std::move(distinct);
}

void requireFlawless(const ImportReport& report, const std::string& path) {
    std::vector<std::string> faults = report.ledger.lines();
    faults.insert(faults.end(), report.warnings.begin(), report.warnings.end());
    if (faults.empty()) return;
    const std::string more = faults.size() > 1 ? fmt::format(" (and {} more)", faults.size() - 1) : "";
    throw Error(ErrorKind::InvalidContent,
                fmt::format("{}: {}{}; --strict takes only what needs no repair", path, faults[0], more));
}

} // namespace

ImportedModel importModel(const std::string& path, const ImportSettings& settings, StageTimer& timer) {
    ImportedModel result;
    ImportReport& report = result.report;
    ModelFolder folder(path);
    SceneParts parts = readParts(path, settings, folder, report, timer);
    settings.progress(0.6);

    timer.begin("repair");
    report.leftOut.push_back(dropInvisible(parts.materials, parts.soup));
    const RepairedSurface surface = repairSoup(parts.soup, settings.repair, path, report.ledger,
                                               [&](double part) { settings.progress(0.6 + 0.3 * part); });
    report.weldedVertices = surface.weld.positions.size();
    report.movedVertices = surface.weld.movedPositions;
    report.generatedNormals = surface.generatedNormals;
    report.decimatedFrom = surface.decimatedFrom;
    report.surface = surface.figures;

    timer.begin("merge");
    skipUnneeded(parts, report.leftOut);
    countRepeats(report.warnings);
    if (settings.strict) requireFlawless(report, path);
    Mesh& mesh = result.mesh;
    mesh = mergeCorners(parts.soup, surface.weld, surface.cornerNormals);
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

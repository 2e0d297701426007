#include "tools/rt-import/import_model.h"

#include "common/error.h"
#include "common/stage_timer.h"
#include "tools/rt-import/files_asked.h"
#include "tools/rt-import/model_folder.h"
#include "tools/rt-import/read_cameras.h"
#include "tools/rt-import/read_model.h"
#include "tools/rt-import/scene_description.h"
#include "tools/rt-import/scene_parts.h"
#include "tools/rt-import/skip_unneeded.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

namespace rt {
namespace {

// All models, one after the other. Warnings name the model where there are several.
SceneParts readModels(const SceneDescription& scene, const ImportSettings& settings, ImportedModel& result,
                      FilesAsked& asked, StageTimer& timer) {
    constexpr double kReadingShare = 0.5; // of the time, about
    const auto count = static_cast<double>(scene.models.size());
    double models = 0.0;
    ImportSettings ofModel = settings;
    ofModel.progress = [&](double part) { settings.progress(kReadingShare * (models + part) / count); };
    const bool several = scene.models.size() > 1 || scene.hasSceneFile;
    std::vector<std::string>& warnings = result.report.warnings;
    Overrides overrides{scene.overrides, std::vector<bool>(scene.overrides.size())};
    SceneParts whole;
    for (const PlacedModel& model : scene.models) {
        const ModelFolder folder(model.path, model.folders, &asked);
        std::vector<std::string> own;
        append(readModel(model, ofModel, overrides, folder, result.report, own, timer), whole, model.path);
        models += 1.0;
        for (const std::string& warning : own)
            warnings.push_back(several ? model.path + ": " + warning : warning);
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

void requireFlawless(const ImportReport& report, const SceneSources& sources) {
    std::vector<std::string> faults = report.ledger.lines();
    faults.insert(faults.end(), report.warnings.begin(), report.warnings.end());
    if (faults.empty()) return;
    const std::string more = faults.size() > 1 ? fmt::format(" (and {} more)", faults.size() - 1) : "";
    throw Error(ErrorKind::InvalidContent, fmt::format("{}{}; --strict takes only what needs no repair",
                                                       withName(sources, faults[0]), more));
}

} // namespace

std::string nameOf(const SceneSources& sources) {
    return fmt::format("{}", fmt::join(sources.inputs, ", "));
}

std::string withName(const SceneSources& sources, const std::string& warning) {
    for (const std::string& input : sources.inputs)
        if (warning.starts_with(input + ": ")) return warning;
    return nameOf(sources) + ": " + warning;
}

ImportedModel importScene(const SceneSources& sources, const ImportSettings& settings, StageTimer& timer) {
    ImportedModel result;
    ImportReport& report = result.report;
    timer.begin("describe");
    FilesAsked asked(sources.inputs, sources.roots);
    SceneDescription scene = describeScene(sources.inputs, sources.roots, &asked);
    report.warnings = scene.warnings;
    SceneParts parts = readModels(scene, settings, result, asked, timer);
    const std::string name = nameOf(sources);
    requireTriangles(parts.soup, name, report.ledger);
    settings.progress(0.6);

    timer.begin("repair");
    report.leftOut.push_back(dropInvisible(parts.materials, parts.soup));
    const RepairedSurface surface = repairSoup(parts.soup, settings.repair, name, report.ledger,
                                               [&](double part) { settings.progress(0.6 + 0.3 * part); });
    report.weldedVertices = surface.weld.positions.size();
    report.movedVertices = surface.weld.movedPositions;
    report.generatedNormals = surface.generatedNormals;
    report.decimatedFrom = surface.decimatedFrom;
    report.surface = surface.figures;

    timer.begin("merge");
    skipUnneeded(parts, report.leftOut);
    countRepeats(report.warnings);
    if (settings.strict) requireFlawless(report, sources);
    Mesh& mesh = result.mesh;
    mesh = mergeCorners(parts.soup, surface.weld, surface.cornerNormals);
    mesh.triangleMaterial = std::move(parts.soup.triangleMaterial);
    mesh.materials = std::move(parts.materials);
    mesh.images = std::move(parts.images.images);
    mesh.pixels = std::move(parts.images.pixels);
    addDescribed(scene, parts, mesh);
    validate(mesh, name);
    timer.end();
    result.filesAsked = asked.text();
    return result;
}

ImportedModel importModel(const std::string& path, const ImportSettings& settings, StageTimer& timer) {
    return importScene({{path}, {}}, settings, timer);
}

} // namespace rt

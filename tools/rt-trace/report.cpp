#include "tools/rt-trace/report.h"

#include "tools/rt-trace/explain.h"
#include "tools/rt-trace/load_scene.h"

#include <nlohmann/json.hpp>

#include <limits>

namespace rt {
namespace {

nlohmann::json toJson(const glm::dvec3& v) {
    return {v.x, v.y, v.z};
}

} // namespace

double mraysPerSecond(std::uint64_t rays, double elapsedMs) {
    return elapsedMs > 0.0 ? static_cast<double>(rays) / elapsedMs * 1e-3
                           : std::numeric_limits<double>::quiet_NaN();
}

void reportCommon(nlohmann::json& report, const GpuScene& scene, const StageTimer& stages) {
    const GlDevice& device = scene.context->device();
    const GridParams& grid = scene.file.atlas.grid;
    report["device"] = device.renderer;
    report["deviceInfo"] = {{"renderer", device.renderer},
                            {"version", device.version},
                            {"driver", device.driver},
                            {"software", device.software},
                            {"index", device.index},
                            {"cudaDevice", device.cuda ? nlohmann::json(*device.cuda) : nlohmann::json()}};
    report["structure"] = structureName(grid.dims.w);
    report["atlas"] = {{"structure", structureName(grid.dims.w)},
                       {"dims", {grid.dims.x, grid.dims.y, grid.dims.z}},
                       {"triangles", grid.counts.x},
                       {"bytes", scene.file.fileBytes}};
    report["gpuMemoryBytes"] = scene.memoryBytes;
    report["shaderFromCache"] = scene.programsFromCache;
    report["features"] = nlohmann::json::array();
    for (const FeatureRow& row : featureTable())
        report["features"].push_back(
            {{"macro", row.macro}, {"value", scene.plan.features.*row.field}, {"reason", row.reason}});
    for (const auto& [stage, ms] : stages.stagesMs()) report[stage + "Ms"] = ms;
    report["peakMemoryBytes"] = peakMemoryBytes();
}

void reportSections(nlohmann::json& report, const GpuScene& scene, bool ownEnvironment) {
    report["sections"] = nlohmann::json::array();
    for (const SectionUse& use : sectionUses(scene.file.atlas, scene.plan, ownEnvironment))
        report["sections"].push_back({{"name", use.name}, {"bytes", use.bytes}, {"uploaded", use.uploaded}});
}

void reportWork(nlohmann::json& report, const WorkTotals& work, double gpuMs) {
    const double rays = static_cast<double>(work.rays);
    report["raysTotal"] = work.rays;
    report["stepsPerRay"] = static_cast<double>(work.steps) / rays;
    report["testsPerRay"] = static_cast<double>(work.tests) / rays;
    report["mraysPerSecond"] = mraysPerSecond(work.rays, gpuMs);
}

void reportCamera(nlohmann::json& report, const CameraPose& pose) {
    report["camera"] = {{"eye", toJson(pose.eye)},
                        {"lookAt", toJson(pose.lookAt)},
                        {"up", toJson(pose.up)},
                        {"fovDegrees", pose.fovDegrees}};
}

} // namespace rt

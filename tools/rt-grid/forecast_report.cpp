#include "tools/rt-grid/forecast_report.h"

#include "tools/rt-grid/inspect_report.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace rt {
namespace {

double megabytes(std::uint64_t bytes) {
    return static_cast<double>(bytes) * 1e-6;
}

std::uint64_t gridVoxels(const BuildForecast& forecast) {
    const glm::uvec3& dims = forecast.sizes.dims;
    return std::uint64_t(dims.x) * dims.y * dims.z;
}

} // namespace

std::uint64_t fileBytesOf(const Mesh& mesh) {
    return mesh.positions.size_bytes() + mesh.normals.size_bytes() + mesh.texcoords.size_bytes() +
           mesh.triangles.size_bytes() + mesh.triangleMaterial.size_bytes() + mesh.materials.size_bytes() +
           mesh.lights.size_bytes() + mesh.cameras.size_bytes() + mesh.cameraKeys.size_bytes() +
           mesh.surroundings.size_bytes() + mesh.environment.size_bytes() + mesh.images.size_bytes() +
           mesh.pixels.size_bytes();
}

std::string textOf(const ForecastReport& report) {
    const BuildForecast& forecast = report.forecast;
    const glm::uvec3& dims = forecast.sizes.dims;
    std::string text =
        fmt::format("{}: {}, {}x{}x{} = {} voxels", report.options.meshPath,
                    structureName(forecast.structure), dims.x, dims.y, dims.z, gridVoxels(forecast));
    if (forecast.structure == kStructureNested)
        text +=
            fmt::format(", about {} bricks of {} voxels in all", forecast.bricks, forecast.sizes.brickWords);
    text += fmt::format("\n{} triangles, {}{} references in {} occupied voxels\n", forecast.sizes.triangles,
                        forecast.structure == kStructureNested ? "about " : "", forecast.references,
                        forecast.occupiedVoxels);
    text += fmt::format(
        "memory to build: about {:.1f} MB: program {:.1f}, mesh {:.1f}, the rest {:.1f}, of {:.0f} "
        "that may be used ({})\n\n",
        megabytes(report.memoryBytes()), megabytes(report.programBytes), megabytes(report.meshBytes),
        megabytes(forecast.peakBytes), megabytes(report.options.build.memory.bytes),
        report.options.build.memory.origin);
    return text + sectionTable(sectionsOf(forecast.sizes), report.devices);
}

nlohmann::json jsonOf(const ForecastReport& report) {
    const BuildForecast& forecast = report.forecast;
    const glm::uvec3& dims = forecast.sizes.dims;
    const std::vector<SectionSize> sections = sectionsOf(forecast.sizes);
    nlohmann::json json;
    json["tool"] = "rt-grid --dry-run";
    json["input"] = report.options.meshPath;
    json["structure"] = structureName(forecast.structure);
    json["resolution"] = {dims.x, dims.y, dims.z};
    json["voxels"] = gridVoxels(forecast);
    json["occupiedVoxels"] = forecast.occupiedVoxels;
    json["references"] = forecast.references;
    json["triangles"] = forecast.sizes.triangles;
    if (forecast.structure == kStructureNested) {
        json["bricks"] = forecast.bricks;
        json["brickWords"] = forecast.sizes.brickWords;
    }
    json["fileBytes"] = fileBytesOf(sections);
    json["memoryBytes"] = report.memoryBytes();
    json["maxMemoryBytes"] = report.options.build.memory.bytes;
    json["sections"] = sectionsJson(sections, report.devices);
    json["refusal"] = forecast.refusal.empty() ? nlohmann::json() : nlohmann::json(forecast.refusal);
    return json;
}

} // namespace rt

#include "tools/rt-grid/report.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>

namespace rt {
namespace {

// Bytes of all that every scene has: the voxels, and the triangles with their vertices' normals.
double bytesPerTriangle(const Atlas& atlas) {
    const std::size_t bytes = atlas.voxels.size_bytes() + atlas.bricks.size_bytes() +
                              atlas.references.size_bytes() + atlas.triangles.size_bytes() +
                              atlas.triangleVertices.size_bytes() + atlas.normals.size_bytes();
    return static_cast<double>(bytes) / static_cast<double>(atlas.triangles.size());
}

struct BrickCounts {
    std::size_t bricks = 0;
    int depth = 0;
    int finestLevel = 0; // the smallest voxels are 2^-finestLevel of the grid's
};

BrickCounts countBricks(const Atlas& atlas) {
    BrickCounts counts;
    for (const BrickPlace& brick : bricksOf(atlas, "atlas")) {
        ++counts.bricks;
        counts.depth = std::max(counts.depth, brick.depth);
        counts.finestLevel = std::max(counts.finestLevel, brick.level);
    }
    return counts;
}

std::string detailOf(const Atlas& atlas) {
    if (atlas.grid.dims.w == kStructureOctant) return "boxes of up to 31 voxels to each side";
    if (atlas.grid.dims.w != kStructureNested)
        return fmt::format("largest distance {}", atlas.info.maxDistance);
    const BrickCounts counts = countBricks(atlas);
    return fmt::format("{} bricks up to {} deep, smallest voxel 1/{}", counts.bricks, counts.depth,
                       1 << counts.finestLevel);
}

double referencesPerTriangle(const Atlas& atlas) {
    return static_cast<double>(atlas.info.references) / static_cast<double>(atlas.triangles.size());
}

std::uint64_t structureBytes(const Atlas& atlas) {
    return atlas.voxels.size_bytes() + atlas.bricks.size_bytes() + atlas.references.size_bytes();
}

// Nothing for standard output and devices.
nlohmann::json fileBytes(const std::string& path) {
    std::error_code unknown;
    const std::uintmax_t bytes = std::filesystem::file_size(path, unknown);
    return unknown ? nlohmann::json() : nlohmann::json(bytes);
}

// What limits.h says of this build, now that the number of references is known.
std::uint64_t forecastMemoryBytes(const GridReport& report) {
    const Atlas& atlas = report.atlas;
    BuildSize size;
    size.dims = atlas.grid.dims;
    size.triangles = atlas.triangles.size();
    size.vertices = atlas.normals.size();
    size.texels = atlas.pages.size();
    size.vdb = report.options.build.vdb;
    size.boxes = hasBoxes(atlas.grid.dims.w);
    const std::uint64_t words =
        hasBoxes(atlas.grid.dims.w) ? atlas.references.size() + atlas.bricks.size() : atlas.info.references;
    return forecastBytes(size) + words * bytesPerReference(size);
}

// Why auto chose as it did.
std::string whyOf(const GridReport& report) {
    const std::optional<StructureChoice>& choice = report.choice;
    if (!choice) return "";
    const bool fits = choice->structure == report.atlas.grid.dims.w;
    return fmt::format("auto: a ray should cost {:.1f} triangle tests with nested and {:.1f} "
                       "with octant, steps included{}; ",
                       choice->nested.cost(), choice->octant.cost(),
                       fits ? "" : ", which the memory has no room for");
}

nlohmann::json jsonOf(const WorkForecast& work) {
    return {{"steps", work.steps}, {"tests", work.tests}, {"cost", work.cost()}};
}

} // namespace

double buildMs(const StageTimer& timer) {
    double total = 0.0;
    for (const auto& [stage, ms] : timer.stagesMs())
        if (stage != "read" && stage != "vdb" && stage != "write") total += ms;
    return total;
}

std::string summaryOf(const GridReport& report) {
    const Atlas& atlas = report.atlas;
    const glm::uvec4& dims = atlas.grid.dims;
    return whyOf(report) +
           fmt::format(
               "{} {}x{}x{} = {} voxels, {} occupied, {:.2f} references per triangle, {}, {:.1f} MB of "
               "voxels and lists for {} triangles, {:.1f} bytes per triangle in all, {:.0f} ms",
               structureName(atlas.grid.dims.w), dims.x, dims.y, dims.z, atlas.voxelCount(),
               atlas.info.occupiedVoxels, referencesPerTriangle(atlas), detailOf(atlas),
               static_cast<double>(structureBytes(atlas)) * 1e-6, atlas.triangles.size(),
               bytesPerTriangle(atlas), buildMs(report.timer));
}

nlohmann::json jsonOf(const GridReport& report) {
    const Atlas& atlas = report.atlas;
    const glm::uvec4& dims = atlas.grid.dims;
    const double ms = buildMs(report.timer);
    nlohmann::json json;
    json["tool"] = "rt-grid";
    json["input"] = report.options.meshPath;
    json["output"] = report.options.atlasPath;
    json["structure"] = structureName(atlas.grid.dims.w);
    if (report.choice)
        json["auto"] = {{"nested", jsonOf(report.choice->nested)}, {"octant", jsonOf(report.choice->octant)}};
    json["resolution"] = {dims.x, dims.y, dims.z};
    json["voxels"] = atlas.voxelCount();
    json["occupiedVoxels"] = atlas.info.occupiedVoxels;
    json["references"] = atlas.info.references;
    json["referencesPerTriangle"] = referencesPerTriangle(atlas);
    json["maxDistance"] = atlas.info.maxDistance;
    json["padCells"] = atlas.info.padCells;
    json["triangles"] = atlas.triangles.size();
    json["vertices"] = atlas.normals.size();
    json["materials"] = atlas.materials.size();
    json["lights"] = atlas.lights.size();
    json["images"] = atlas.images.size();
    json["texturePages"] = {atlas.info.pageWidth, atlas.info.pageHeight, atlas.info.pageCount};
    if (atlas.grid.dims.w == kStructureNested) {
        const BrickCounts counts = countBricks(atlas);
        json["bricks"] = counts.bricks;
        json["brickWords"] = atlas.bricks.size();
        json["brickDepth"] = counts.depth;
        json["finestLevel"] = counts.finestLevel;
    }
    json["bytesPerTriangle"] = bytesPerTriangle(atlas);
    json["structureBytes"] = structureBytes(atlas);
    json["fileBytes"] = fileBytes(report.options.atlasPath);
    json["meshHash"] = fmt::format("{:016x}", atlas.info.meshHash);
    for (const auto& [stage, stageMs] : report.timer.stagesMs()) json["stagesMs"][stage] = stageMs;
    json["buildMs"] = ms;
    json["trianglesPerSecond"] = static_cast<double>(atlas.triangles.size()) / (ms * 1e-3);
    json["peakMemoryBytes"] = peakMemoryBytes();
    json["forecastMemoryBytes"] = forecastMemoryBytes(report);
    json["maxMemoryBytes"] = report.options.build.memory.bytes;
    return json;
}

} // namespace rt

#include "tools/rt-grid/inspect_report.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <bit>
#include <cmath>

namespace rt {
namespace {

double share(double part, double whole) {
    return whole > 0.0 ? 100.0 * part / whole : 0.0;
}

// "1", "2", "3-4", "5-8", ...: values from `first` to `last`.
std::string rangeName(std::size_t first, std::size_t last) {
    return first == last ? fmt::format("{}", first) : fmt::format("{}-{}", first, last);
}

std::string bar(double percent) {
    const auto length = static_cast<std::size_t>(std::lround(percent * 0.4));
    return length == 0 ? "" : fmt::format(" {:#>{}}", "", length);
}

// One line for each power of two.
std::string histogramText(const char* title, const Histogram& histogram) {
    std::string text =
        fmt::format("{}: mean {:.2f}, largest {}\n", title, histogram.mean(), histogram.largest());
    const std::vector<std::uint64_t>& counts = histogram.counts();
    for (std::size_t first = 0; first < counts.size();) {
        const std::size_t last = std::min(first == 0 ? 0 : std::bit_ceil(first), counts.size() - 1);
        std::uint64_t sum = 0;
        for (std::size_t value = first; value <= last; ++value) sum += counts[value];
        const double percent = share(static_cast<double>(sum), static_cast<double>(histogram.count()));
        if (sum > 0)
            text += fmt::format("  {:>11} {:>12} {:5.1f} %{}\n", rangeName(first, last), sum, percent,
                                bar(percent));
        first = last + 1;
    }
    return text;
}

std::string bricksText(const LevelFigures& level) {
    std::string text;
    for (const auto& [side, count] : level.bricks)
        text += fmt::format("{}{} of {}^3", text.empty() ? "" : ", ", count, side);
    return text;
}

std::string levelTable(const InspectReport& report) {
    const Atlas& atlas = report.file.atlas;
    std::string text = fmt::format("{:>5} {:>11} {:>12} {:>12} {:>12} {:>12} {:>12}  {}\n", "level", "voxel",
                                   "voxels", "empty", "leaves", "with bricks", "references", "made of");
    for (std::size_t i = 0; i < report.figures.levels.size(); ++i) {
        const LevelFigures& level = report.figures.levels[i];
        if (level.voxels() == 0) continue;
        const double side =
            std::ldexp(atlas.grid.cellSize[0] / atlas.grid.worldOffset.w, -static_cast<int>(i));
        text += fmt::format("{:>5} {:>11.4g} {:>12} {:>12} {:>12} {:>12} {:>12}  {}\n", i, side,
                            level.voxels(), level.empty, level.leaves, level.crowded, level.references,
                            i == 0 ? "the grid" : bricksText(level));
    }
    return text;
}

std::string workText(const char* name, const WorkPerRay& work) {
    return fmt::format("  {:<34} {:>7.2f} steps {:>8.2f} tests {:>5.1f} % hit\n", name, work.steps,
                       work.tests, 100.0 * work.hits);
}

std::string headText(const InspectReport& report) {
    const Atlas& atlas = report.file.atlas;
    const glm::uvec4& dims = atlas.grid.dims;
    const AtlasInfo& info = atlas.info;
    const auto finest = static_cast<int>(report.figures.levels.size()) - 1;
    std::string text = fmt::format("{}: {}, {} voxels along x, {} y, {} z", report.path,
                                   structureName(dims.w), dims.x, dims.y, dims.z);
    if (finest > 0)
        text += fmt::format(", as fine as {}x{}x{}", std::uint64_t(dims.x) << finest,
                            std::uint64_t(dims.y) << finest, std::uint64_t(dims.z) << finest);
    text += fmt::format("\n{} triangles, {} vertices, {} materials, {} lights, {} cameras, {} images\n",
                        atlas.triangles.size(), atlas.normals.size(), atlas.materials.size(),
                        atlas.lights.size(), atlas.cameras.size(), atlas.images.size());
    text +=
        fmt::format("scene from ({:.6g}, {:.6g}, {:.6g}) to ({:.6g}, {:.6g}, {:.6g}); pad {:.4g} voxels\n",
                    info.worldLo[0], info.worldLo[1], info.worldLo[2], info.worldHi[0], info.worldHi[1],
                    info.worldHi[2], info.padCells);
    text += fmt::format("hash {:016x}, of the mesh {:016x}\n", report.file.contentHash, info.meshHash);
    text += fmt::format("occupied: {} voxels, {:.2f} % of the volume\n", info.occupiedVoxels,
                        100.0 * report.figures.occupiedVolume);
    return text;
}

nlohmann::json jsonOf(const Histogram& histogram) {
    nlohmann::json json{
        {"count", histogram.count()}, {"mean", histogram.mean()}, {"max", histogram.largest()}};
    json["histogram"] = nlohmann::json::array();
    for (std::size_t value = 0; value < histogram.counts().size(); ++value)
        if (histogram.counts()[value] > 0) json["histogram"].push_back({value, histogram.counts()[value]});
    return json;
}

nlohmann::json jsonOf(const WorkPerRay& work) {
    return {{"steps", work.steps}, {"tests", work.tests}, {"hits", work.hits}};
}

nlohmann::json levelsJson(const InspectReport& report) {
    nlohmann::json json = nlohmann::json::array();
    for (std::size_t i = 0; i < report.figures.levels.size(); ++i) {
        const LevelFigures& level = report.figures.levels[i];
        if (level.voxels() == 0) continue;
        nlohmann::json bricks = nlohmann::json::array();
        for (const auto& [side, count] : level.bricks) bricks.push_back({{"side", side}, {"count", count}});
        json.push_back({{"level", i},
                        {"voxels", level.voxels()},
                        {"empty", level.empty},
                        {"leaves", level.leaves},
                        {"crowded", level.crowded},
                        {"references", level.references},
                        {"bricks", bricks}});
    }
    return json;
}

} // namespace

std::string sectionTable(const std::vector<SectionSize>& sections, const std::vector<DeviceLimits>& devices) {
    std::string text = fmt::format("{:<8} {:>14}  {:<28}", "section", "bytes", "on a GPU");
    for (const DeviceLimits& device : devices)
        text += fmt::format("  {:<24.24}", device.name.substr(0, device.name.find(" (")));
    for (const SectionSize& section : sections) {
        text += fmt::format("\n{:<8} {:>14}  {:<28}", section.id, section.bytes, nameOf(section));
        for (const DeviceLimits& device : devices) text += fmt::format("  {:<24}", fitOf(section, device));
    }
    text += fmt::format("\n{:<8} {:>14}  the file\n", "all", fileBytesOf(sections));
    std::string trimmed; // no spaces at the ends of lines
    for (const char c : text) {
        if (c == '\n') trimmed.erase(trimmed.find_last_not_of(' ') + 1);
        trimmed += c;
    }
    return trimmed;
}

nlohmann::json sectionsJson(const std::vector<SectionSize>& sections,
                            const std::vector<DeviceLimits>& devices) {
    nlohmann::json json;
    for (const SectionSize& section : sections) {
        nlohmann::json fits = nlohmann::json::object();
        for (const DeviceLimits& device : devices) fits[device.name] = fitOf(section, device);
        json.push_back(
            {{"id", section.id}, {"bytes", section.bytes}, {"gpu", nameOf(section)}, {"fits", fits}});
    }
    return json;
}

std::string textOf(const InspectReport& report) {
    const AtlasFigures& figures = report.figures;
    std::string text = headText(report) + "\n" + levelTable(report) + "\n";
    if (report.file.atlas.grid.dims.w != kStructureUniform)
        text += histogramText("distance from empty voxels to what stops rays, in voxels", figures.distances) +
                "\n";
    if (figures.extents.count() > 0) {
        text += histogramText("free voxels to each side of an empty one", figures.extents) + "\n";
        text += histogramText("free voxels to each side of a leaf, in its exit box", figures.exits) + "\n";
    }
    text += histogramText("references per leaf", figures.referencesPerLeaf) + "\n";
    text += histogramText("references per triangle", figures.referencesPerTriangle) + "\n";
    text += sectionTable(sectionsOf(sizesOf(report.file.atlas)), report.devices) + "\n";
    text += fmt::format("a ray, of {} of each kind:\n", report.rays.rays);
    text += workText("across the scene, anywhere", report.rays.across);
    text += workText("from outside to a triangle", report.rays.towards);
    text += workText("from a triangle on, to any side", report.rays.from);
    return text;
}

nlohmann::json jsonOf(const InspectReport& report) {
    const Atlas& atlas = report.file.atlas;
    const glm::uvec4& dims = atlas.grid.dims;
    const AtlasFigures& figures = report.figures;
    nlohmann::json json;
    json["tool"] = "rt-grid inspect";
    json["input"] = report.path;
    json["structure"] = structureName(dims.w);
    json["resolution"] = {dims.x, dims.y, dims.z};
    json["atlasHash"] = fmt::format("{:016x}", report.file.contentHash);
    json["meshHash"] = fmt::format("{:016x}", atlas.info.meshHash);
    json["worldLo"] = atlas.info.worldLo;
    json["worldHi"] = atlas.info.worldHi;
    json["padCells"] = atlas.info.padCells;
    json["triangles"] = atlas.triangles.size();
    json["vertices"] = atlas.normals.size();
    json["occupiedVoxels"] = atlas.info.occupiedVoxels;
    json["occupiedVolume"] = figures.occupiedVolume;
    json["references"] = atlas.info.references;
    json["levels"] = levelsJson(report);
    json["distances"] = jsonOf(figures.distances);
    json["extents"] = jsonOf(figures.extents);
    json["exits"] = jsonOf(figures.exits);
    json["referencesPerLeaf"] = jsonOf(figures.referencesPerLeaf);
    json["referencesPerTriangle"] = jsonOf(figures.referencesPerTriangle);
    json["sections"] = sectionsJson(sectionsOf(sizesOf(atlas)), report.devices);
    json["fileBytes"] = report.file.fileBytes;
    for (const DeviceLimits& device : report.devices)
        json["devices"].push_back({{"name", device.name},
                                   {"bufferBytes", device.bufferBytes},
                                   {"textureSide3D", device.textureSide3D},
                                   {"textureSide2D", device.textureSide2D},
                                   {"arrayLayers", device.arrayLayers}});
    json["rays"] = {{"ofEachKind", report.rays.rays},
                    {"across", jsonOf(report.rays.across)},
                    {"towards", jsonOf(report.rays.towards)},
                    {"from", jsonOf(report.rays.from)}};
    return json;
}

} // namespace rt

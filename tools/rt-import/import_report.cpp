#include "tools/rt-import/import_report.h"

#include "common/stage_timer.h"
#include "formats/mesh.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace rt {
namespace {

nlohmann::json toJson(const glm::vec3& v) {
    return {v.x, v.y, v.z};
}

nlohmann::json toJson(const SurfaceFigures& figures) {
    return {{"components", figures.components},
            {"closedComponents", figures.closedComponents},
            {"boundaryEdges", figures.boundaryEdges},
            {"nonManifoldEdges", figures.nonManifoldEdges},
            {"splitVertices", figures.splitVertices}};
}

nlohmann::json toJson(const std::vector<LeftOut>& leftOut) {
    nlohmann::json kinds = nlohmann::json::object();
    for (const LeftOut& kind : leftOut)
        if (kind.count > 0) kinds[kind.what] = {{"count", kind.count}, {"bytes", kind.bytes}};
    return kinds;
}

} // namespace

std::uint64_t byteCount(const Mesh& mesh) {
    return mesh.positions.size_bytes() + mesh.normals.size_bytes() + mesh.texcoords.size_bytes() +
           mesh.triangles.size_bytes() + mesh.triangleMaterial.size_bytes() + mesh.materials.size_bytes() +
           mesh.lights.size_bytes() + mesh.cameras.size_bytes() + mesh.images.size_bytes() +
           mesh.pixels.size_bytes() + mesh.cameraKeys.size_bytes() + mesh.surroundings.size_bytes() +
           mesh.environment.size_bytes();
}

std::uint64_t byteCount(const std::vector<LeftOut>& leftOut) {
    std::uint64_t bytes = 0;
    for (const LeftOut& kind : leftOut) bytes += kind.bytes;
    return bytes;
}

std::vector<std::string> detailLines(const ImportReport& report) {
    const SurfaceFigures& surface = report.surface;
    std::vector<std::string> lines{
        fmt::format("{} components, {} of them closed; {} border edges; {} edges of more than two faces, {} "
                    "vertices split",
                    surface.components, surface.closedComponents, surface.boundaryEdges,
                    surface.nonManifoldEdges, surface.splitVertices)};
    if (report.movedVertices > 0) lines.push_back(fmt::format("{} vertices welded", report.movedVertices));
    if (report.decimatedFrom > 0)
        lines.push_back(fmt::format("decimated from {} triangles", report.decimatedFrom));
    for (const LeftOut& kind : report.leftOut)
        if (kind.count > 0)
            lines.push_back(fmt::format("left out: {} {}, {} bytes", kind.count, kind.what, kind.bytes));
    return lines;
}

nlohmann::json toJson(const ImportReport& report, const Mesh& mesh, const StageTimer& timer) {
    const Bounds bounds = boundsOf(mesh);
    nlohmann::json stages = nlohmann::json::object();
    for (const auto& [stage, ms] : timer.stagesMs()) stages[stage] = ms;
    return {{"triangles", mesh.triangles.size()},
            {"vertices", mesh.positions.size()},
            {"weldedVertices", report.weldedVertices},
            {"materials", mesh.materials.size()},
            {"images", mesh.images.size()},
            {"lights", mesh.lights.size()},
            {"cameras", mesh.cameras.size()},
            {"bytes", byteCount(mesh)},
            {"movedVertices", report.movedVertices},
            {"generatedNormals", report.generatedNormals},
            {"decimatedFrom", report.decimatedFrom},
            {"ledger", report.ledger.toJson()},
            {"surface", toJson(report.surface)},
            {"leftOut", toJson(report.leftOut)},
            {"leftOutBytes", byteCount(report.leftOut)},
            {"bounds", {{"lo", toJson(bounds.lo)}, {"hi", toJson(bounds.hi)}}},
            {"warnings", report.warnings},
            {"stagesMs", stages},
            {"peakMemoryBytes", peakMemoryBytes()}};
}

} // namespace rt

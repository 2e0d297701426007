#include "tools/rt-import/import_report.h"

#include "common/stage_timer.h"
#include "formats/mesh.h"

#include <nlohmann/json.hpp>

namespace rt {
namespace {

nlohmann::json toJson(const glm::vec3& v) {
    return {v.x, v.y, v.z};
}

} // namespace

std::uint64_t byteCount(const Mesh& mesh) {
    return mesh.positions.size_bytes() + mesh.normals.size_bytes() + mesh.texcoords.size_bytes() +
           mesh.triangles.size_bytes() + mesh.triangleMaterial.size_bytes() + mesh.materials.size_bytes() +
           mesh.lights.size_bytes() + mesh.cameras.size_bytes() + mesh.images.size_bytes() +
           mesh.pixels.size_bytes() + mesh.cameraKeys.size_bytes() + mesh.surroundings.size_bytes() +
           mesh.environment.size_bytes();
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
            {"droppedFaces", report.droppedFaces},
            {"degenerateTriangles", report.degenerateTriangles},
            {"nonManifoldFaces", report.nonManifoldFaces},
            {"generatedNormals", report.generatedNormals},
            {"bounds", {{"lo", toJson(bounds.lo)}, {"hi", toJson(bounds.hi)}}},
            {"warnings", report.warnings},
            {"stagesMs", stages},
            {"peakMemoryBytes", peakMemoryBytes()}};
}

} // namespace rt

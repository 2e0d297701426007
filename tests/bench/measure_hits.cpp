// Measures how far the hits that rt-trace found are from those that it finds in double precision:
//     rt_measure_hits reference.hits got.hits --rays x.rays --mesh scene.rtmesh --json FILE
#include "common/binary_io.h"
#include "common/command_line.h"
#include "common/error.h"
#include "common/json_file.h"
#include "common/run_tool.h"
#include "formats/mesh_file.h"
#include "tests/bench/embree_tracer.h"
#include "tests/bench/hit_error.h"
#include "tests/bench/ray_files.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>

namespace rt::bench {
namespace {

struct Options {
    CommonOptions common;
    std::string referencePath, gotPath, raysPath, meshPath;
};

bool parse(int argc, const char* const* argv, Options& options) {
    CLI::App app("Measures errors of hits against those of `rt-trace --precision double`: t, position and "
                 "normal where both hit the same triangle, and hits that are lost or of wrong triangles.",
                 "rt_measure_hits");
    addCommonOptions(app, options.common, "Embree " + EmbreeTracer::version());
    app.add_option("reference", options.referencePath, "64-bit hits")->required()->type_name("FILE");
    app.add_option("got", options.gotPath, "Hits to judge, 32-bit or 64-bit ones as the file's size tells")
        ->required()
        ->type_name("FILE");
    app.add_option("--rays", options.raysPath, "The rays of both")->required()->type_name("FILE");
    app.add_option("--mesh", options.meshPath, "Their scene")->required()->type_name("scene.rtmesh");
    return parseCommandLine(app, argc, argv, options.common);
}

std::vector<QueryHitDouble> readReference(const std::string& path, std::size_t rays) {
    const SharedSpan<std::byte> bytes = readFile(path);
    if (bytes.size() != rays * sizeof(QueryHitDouble))
        throw Error(
            ErrorKind::InvalidContent,
            fmt::format("{}: {} bytes are no 64-bit hits of {} rays, 32 each; trace the reference with "
                        "--precision double",
                        path, bytes.size(), rays));
    const auto records = recordsOf<QueryHitDouble>(bytes, path);
    return {records.begin(), records.end()};
}

// Of either width.
std::vector<QueryHitDouble> readHits(const std::string& path, std::size_t rays) {
    const SharedSpan<std::byte> bytes = readFile(path);
    std::vector<QueryHitDouble> hits(rays);
    if (bytes.size() == rays * sizeof(QueryHit))
        std::ranges::transform(recordsOf<QueryHit>(bytes, path), hits.begin(), widened);
    else if (bytes.size() == rays * sizeof(QueryHitDouble))
        std::ranges::copy(recordsOf<QueryHitDouble>(bytes, path), hits.begin());
    else
        throw Error(
            ErrorKind::InvalidContent,
            fmt::format("{}: {} bytes are no hits of {} rays, 16 or 32 each", path, bytes.size(), rays));
    return hits;
}

nlohmann::json toJson(const ErrorSpread& spread) {
    return {{"median", spread.median}, {"p999", spread.p999}, {"max", spread.max}};
}

nlohmann::json reportOf(const HitErrors& errors, const HitFaults& faults) {
    nlohmann::json report = toJson(faults.counts);
    report["compared"] = errors.compared;
    report["tRelative"] = toJson(errors.t);
    report["positionDiagonals"] = toJson(errors.position);
    report["normalRadians"] = toJson(errors.normal);
    report["wrongTriangles"] = faults.wrongTriangles;
    const double hits = static_cast<double>(faults.counts.hits);
    report["wrongTriangleRate"] = static_cast<double>(faults.wrongTriangles) / hits;
    report["leakRate"] = static_cast<double>(faults.counts[HitClass::Lost]) / hits;
    return report;
}

int measureHits(int argc, const char* const* argv) {
    Options options;
    if (!parse(argc, argv, options)) return 0;
    const SharedSpan<std::byte> rayBytes = readFile(options.raysPath);
    const std::span<const QueryRay> rays = recordsOf<QueryRay>(rayBytes, options.raysPath);
    const std::vector<QueryHitDouble> reference = readReference(options.referencePath, rays.size());
    const std::vector<QueryHitDouble> got = readHits(options.gotPath, rays.size());
    const MeshFile file = readMesh(options.meshPath);
    const HitErrors errors = measureErrors(file.mesh, reference, got);
    const HitFaults faults = findFaults(file.mesh, rays, reference, got);
    const nlohmann::json report = reportOf(errors, faults);
    if (!options.common.jsonPath.empty()) writeJson(options.common.jsonPath, report);
    if (!options.common.quiet && options.common.jsonPath != "-") writeFile("-", report.dump(2) + "\n");
    return 0;
}

} // namespace
} // namespace rt::bench

int main(int argc, char** argv) {
    return rt::runTool("rt_measure_hits", argc, argv, rt::bench::measureHits);
}

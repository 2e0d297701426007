// Compares the hits that rt-trace found with those that rt_make_rays wrote; exit code 1 if they differ:
//     rt_check_hits expected.hits got.hits --rays x.rays --mesh scene.rtmesh
//                   [--any-hit] [--allow-per-million N]
#include "common/binary_io.h"
#include "common/command_line.h"
#include "common/error.h"
#include "common/json_file.h"
#include "common/log.h"
#include "common/run_tool.h"
#include "formats/mesh_file.h"
#include "tests/bench/embree_tracer.h"
#include "tests/bench/hit_check.h"
#include "tests/bench/ray_files.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <bit>

namespace rt::bench {
namespace {

constexpr std::size_t kListedFaults = 16; // with -v

struct Options {
    CommonOptions common;
    std::string expectedPath, gotPath, raysPath, meshPath;
    bool anyHit = false;
    double allowPerMillion = 0.0;
};

bool parse(int argc, const char* const* argv, Options& options) {
    CLI::App app(
        "Compares hits with expected ones. Ties, where a ray meets an edge and another triangle is found at "
        "the same distance, pass; hits that are lost, extra or elsewhere do not.",
        "rt_check_hits");
    addCommonOptions(app, options.common, "Embree " + EmbreeTracer::version());
    app.add_option("expected", options.expectedPath, "Hits to expect")->required()->type_name("FILE");
    app.add_option("got", options.gotPath, "Hits to judge")->required()->type_name("FILE");
    app.add_option("--rays", options.raysPath, "The rays of both")->required()->type_name("FILE");
    app.add_option(
           "--mesh", options.meshPath,
           "Their scene: then silhouettes, where rounding decides, pass too, and triangle, u and v have "
           "to fit t")
        ->type_name("scene.rtmesh");
    app.add_flag("--any-hit", options.anyHit, "Compare hit and miss only");
    app.add_option("--allow-per-million", options.allowPerMillion,
                   "Lost, extra and wrong hits per million rays that still pass")
        ->check(CLI::Range(0.0, 1e6))
        ->capture_default_str();
    return parseCommandLine(app, argc, argv, options.common);
}

std::string describe(const QueryHit& hit) {
    if (hit.tuvId.w == kNoTriangle) return "a miss";
    return fmt::format("triangle {} at t = {:.9g} (u = {:.9g}, v = {:.9g})", hit.tuvId.w,
                       std::bit_cast<float>(hit.tuvId.x), std::bit_cast<float>(hit.tuvId.y),
                       std::bit_cast<float>(hit.tuvId.z));
}

std::string summaryOf(const HitCounts& counts) {
    std::string text = fmt::format("{} rays, {} hits:", counts.rays, counts.hits);
    for (std::size_t c = 0; c < kHitClassNames.size(); ++c)
        text += fmt::format("{} {} {}", c ? "," : "", counts.ofClass[c], kHitClassNames[c]);
    return text + "\n";
}

HitCounts judge(const Options& options, const TracedRays& traced) {
    HitCounts counts = compareHits(traced);
    if (!options.meshPath.empty()) {
        const MeshFile file = readMesh(options.meshPath);
        if (!counts.faults.empty())
            excuseEdges(EmbreeTracer(file.mesh, EmbreeMode::Robust, 1), traced, counts);
        findDisplaced(file.mesh, traced, counts);
    }
    for (std::size_t n = 0; n < std::min(counts.faults.size(), kListedFaults); ++n) {
        const std::size_t i = counts.faults[n];
        logDetail(fmt::format("ray {}: expected {}, got {}", i, describe(traced.expected[i]),
                              describe(traced.got[i])));
    }
    return counts;
}

int checkHits(int argc, const char* const* argv) {
    Options options;
    if (!parse(argc, argv, options)) return 0;
    const SharedSpan<std::byte> rayBytes = readFile(options.raysPath);
    const SharedSpan<std::byte> expectedBytes = readFile(options.expectedPath);
    const SharedSpan<std::byte> gotBytes = readFile(options.gotPath);
    const TracedRays traced{recordsOf<QueryRay>(rayBytes, options.raysPath),
                            recordsOf<QueryHit>(expectedBytes, options.expectedPath),
                            recordsOf<QueryHit>(gotBytes, options.gotPath), options.anyHit};
    if (traced.expected.size() != traced.rays.size() || traced.got.size() != traced.rays.size())
        throw Error(ErrorKind::InvalidContent,
                    fmt::format("{}: {} rays, but {} expected hits and {} to judge", options.raysPath,
                                traced.rays.size(), traced.expected.size(), traced.got.size()));
    const HitCounts counts = judge(options, traced);
    const bool passes = static_cast<double>(counts.faults.size()) <=
                        options.allowPerMillion * 1e-6 * static_cast<double>(counts.rays);
    nlohmann::json report = toJson(counts);
    report["verdict"] = passes ? "pass" : "fail"; // as rt-compare says it
    if (!options.common.jsonPath.empty()) writeJson(options.common.jsonPath, report);
    if (!options.common.quiet && options.common.jsonPath != "-") writeFile("-", summaryOf(counts));
    return passes ? 0 : 1;
}

} // namespace
} // namespace rt::bench

int main(int argc, char** argv) {
    return rt::runTool("rt_check_hits", argc, argv, rt::bench::checkHits);
}

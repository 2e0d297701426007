// Writes the benchmark's ray sets for a scene and the hits that Embree finds, and measures Embree:
//     rt_make_rays scene.rtmesh -o FOLDER [--size 2048] [--eye X,Y,Z --target X,Y,Z] [--light X,Y,Z] [--json
//     FILE]
#include "common/command_line.h"
#include "common/error.h"
#include "common/json_file.h"
#include "common/log.h"
#include "common/run_tool.h"
#include "formats/mesh_file.h"
#include "tests/bench/embree_tracer.h"
#include "tests/bench/ray_sets.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <tbb/task_arena.h>

#include <algorithm>
#include <filesystem>

namespace rt::bench {
namespace {

struct Options {
    CommonOptions common;
    std::string meshPath;
    std::string folder;
    std::uint32_t size = 2048;
    std::string eye, target, up = "0,1,0", light;
    double fovDegrees = 45.0;
    unsigned repeat = 3;
};

bool parse(int argc, const char* const* argv, Options& options) {
    CLI::App app(
        "Writes FOLDER/{primary,shadow,diffuse,random}.rays for rt-trace --rays, and the hits of the same "
        "rays as Embree's robust mode finds them, FOLDER/*.hits; measures Embree's faster mode on all cores.",
        "rt_make_rays");
    addCommonOptions(app, options.common, "Embree " + EmbreeTracer::version());
    app.add_option("mesh", options.meshPath, "Input")->required()->type_name("scene.rtmesh");
    app.add_option("-o,--output", options.folder, "Made if it is not there")->required()->type_name("FOLDER");
    app.add_option("--size", options.size, "Width and height of the picture, a multiple of 8")
        ->check(CLI::Range(8, 8192))
        ->capture_default_str();
    app.add_option("--eye", options.eye, "Where the camera stands; else where the scene fills the picture");
    app.add_option("--target", options.target, "What it looks at; else the centre of the scene");
    app.add_option("--up", options.up, "Up in the picture")->capture_default_str();
    app.add_option("--fov", options.fovDegrees, "Field of view in degrees")
        ->check(CLI::Range(1.0, 170.0))
        ->capture_default_str();
    app.add_option("--light", options.light, "Where shadow rays go; else above the scene");
    app.add_option("--embree-repeat", options.repeat,
                   "Build and trace so often with Embree; medians are reported")
        ->check(CLI::Range(1, 1000))
        ->capture_default_str();
    if (!parseCommandLine(app, argc, argv, options.common)) return false;
    if (options.size % 8 != 0)
        throw Error(ErrorKind::Usage, fmt::format("--size: {} is no multiple of 8", options.size));
    return true;
}

glm::dvec3 pointOr(const std::string& text, const char* option, const glm::dvec3& otherwise) {
    if (text.empty()) return otherwise;
    const std::vector<double> v = parseNumbers(text, 3, option);
    return {v[0], v[1], v[2]};
}

Camera cameraOf(const Options& options, const Bounds& bounds) {
    Camera camera;
    camera.fovDegrees = options.fovDegrees;
    camera.up = pointOr(options.up, "--up", camera.up);
    camera.target = pointOr(options.target, "--target", glm::dvec3(bounds.centre()));
    camera.eye = pointOr(options.eye, "--eye", framingEye(bounds, camera.target));
    return camera;
}

nlohmann::json toJson(const glm::dvec3& v) {
    return {v.x, v.y, v.z};
}

struct Tracers {
    EmbreeTracer reference;
    EmbreeTracer measured;
};

// Traces the rays with Embree, writes both files and returns the reference's hits.
std::vector<QueryHit> finishSet(const Options& options, const Tracers& tracers, const std::string& name,
                                const std::vector<QueryRay>& rays, nlohmann::json& report) {
    const bool anyHit = name == "shadow";
    EmbreeTracer::Traced traced = tracers.reference.trace(rays, anyHit, 1);
    const double singleMs = tracers.measured.trace(rays, anyHit, options.repeat).passMs;
    const double packetMs = tracers.measured.packetPassMs(rays, anyHit, options.repeat);
    const double passMs = std::min(singleMs, packetMs);
    const std::string base = options.folder + "/" + name;
    writeFile(base + ".rays", std::as_bytes(std::span(rays)));
    writeFile(base + ".hits", std::as_bytes(std::span(traced.hits)));
    const auto hitCount = std::count_if(traced.hits.begin(), traced.hits.end(),
                                        [](const QueryHit& hit) { return hit.tuvId.w != kNoTriangle; });
    const double mraysPerSecond = static_cast<double>(rays.size()) / (passMs * 1e3);
    const bool packets = packetMs < singleMs;
    logInfo(fmt::format("{}: {} rays, {} hits, Embree {:.2f} Mrays/s{}", name, rays.size(), hitCount,
                        mraysPerSecond, packets ? " in packets of 16" : ""));
    report["sets"][name] = {{"rays", rays.size()},
                            {"hits", hitCount},
                            {"anyHit", anyHit},
                            {"embreePackets", packets},
                            {"embreeMraysPerSecond", mraysPerSecond}};
    return std::move(traced.hits);
}

struct View {
    Camera camera;
    glm::dvec3 light;
};

void makeSets(const Options& options, const Mesh& mesh, const View& view, const Tracers& tracers,
              nlohmann::json& report) {
    const std::vector<QueryRay> primary = primaryRays(view.camera, options.size);
    const std::vector<QueryHit> hits = finishSet(options, tracers, "primary", primary, report);
    finishSet(options, tracers, "shadow", shadowRays(mesh, primary, hits, view.light), report);
    std::vector<QueryRay> diffuse = diffuseRays(mesh, primary, hits);
    finishSet(options, tracers, "diffuse", diffuse, report);
    finishSet(options, tracers, "random", shuffled(std::move(diffuse)), report);
}

nlohmann::json reportOf(const Options& options, const Mesh& mesh, const View& view, double embreeBuildMs) {
    return {{"triangles", mesh.triangles.size()},
            {"size", options.size},
            {"eye", toJson(view.camera.eye)},
            {"target", toJson(view.camera.target)},
            {"up", toJson(view.camera.up)},
            {"fovDegrees", view.camera.fovDegrees},
            {"light", toJson(view.light)},
            {"embreeVersion", EmbreeTracer::version()},
            {"embreeBuildMs", embreeBuildMs},
            {"embreeBuildMtrisPerSecond", static_cast<double>(mesh.triangles.size()) / (embreeBuildMs * 1e3)},
            {"threads", tbb::this_task_arena::max_concurrency()}};
}

int makeRays(int argc, const char* const* argv) {
    Options options;
    if (!parse(argc, argv, options)) return 0;
    const MeshFile file = readMesh(options.meshPath);
    const Mesh& mesh = file.mesh;
    if (mesh.triangles.empty())
        throw Error(ErrorKind::InvalidContent, options.meshPath + ": no triangles to hit");
    const Bounds bounds = boundsOf(mesh);
    const View view{cameraOf(options, bounds), pointOr(options.light, "--light", lightAbove(bounds))};
    std::filesystem::create_directories(options.folder);
    const Tracers tracers{EmbreeTracer(mesh, EmbreeMode::Robust, 1),
                          EmbreeTracer(mesh, EmbreeMode::Fast, options.repeat)};
    const double buildMs = tracers.measured.buildMs();
    logInfo(fmt::format("{} triangles, Embree's build {:.1f} ms", mesh.triangles.size(), buildMs));
    nlohmann::json report = reportOf(options, mesh, view, buildMs);
    makeSets(options, mesh, view, tracers, report);
    if (!options.common.jsonPath.empty()) writeJson(options.common.jsonPath, report);
    return 0;
}

} // namespace
} // namespace rt::bench

int main(int argc, char** argv) {
    return rt::runTool("rt_make_rays", argc, argv, rt::bench::makeRays);
}

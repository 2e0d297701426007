// Triangles per second of rt-grid's builds, with Embree's high-quality BVH build as the peer of the same run:
//     build/release/bin/rt_build_benchmark [scene.rtmesh]
#include "formats/mesh_file.h"
#include "tests/support/embree_scene.h"
#include "tests/support/make_mesh.h"
#include "tools/rt-grid/build_atlas.h"

#include <benchmark/benchmark.h>

namespace rt {
namespace {

MeshFile& scene() {
    static MeshFile file{test::makeSphere(7), 0};
    return file;
}

void countTriangles(benchmark::State& state) {
    const auto triangles = static_cast<double>(scene().mesh.triangles.size());
    state.counters["triangles/s"] =
        benchmark::Counter(triangles, benchmark::Counter::kIsIterationInvariantRate);
}

void build(benchmark::State& state, const BuildOptions& options) {
    for (auto _ : state) {
        StageTimer timer;
        const BuiltAtlas built = buildAtlas(scene(), "scene", options, timer);
        benchmark::DoNotOptimize(built.atlas.voxels.data());
    }
    countTriangles(state);
}

void buildStructure(benchmark::State& state, std::uint32_t structure) {
    BuildOptions options;
    options.structure = structure;
    build(state, options);
}

void buildAuto(benchmark::State& state, Quality quality) {
    BuildOptions options;
    options.quality = quality;
    build(state, options);
}

void buildEmbree(benchmark::State& state) {
    RTCDevice device = rtcNewDevice(nullptr);
    for (auto _ : state) {
        RTCScene embreeScene = test::newEmbreeScene(device, scene().mesh);
        rtcCommitScene(embreeScene);
        rtcReleaseScene(embreeScene);
    }
    rtcReleaseDevice(device);
    countTriangles(state);
}

template <class F, class... Arguments>
void add(const char* name, F* function, Arguments... arguments) {
    benchmark::RegisterBenchmark(name, [=](benchmark::State& state) { function(state, arguments...); })
        ->Unit(benchmark::kMillisecond)
        ->UseRealTime()
        ->MeasureProcessCPUTime();
}

void addAll() {
    add("uniform", buildStructure, kStructureUniform);
    add("cloud", buildStructure, kStructureCloud);
    add("octant", buildStructure, kStructureOctant);
    add("auto, fast", buildAuto, Quality::fast);
    add("auto, balanced", buildAuto, Quality::balanced);
    add("auto, best", buildAuto, Quality::best);
    add("Embree, high quality", buildEmbree);
}

} // namespace
} // namespace rt

int main(int argc, char** argv) {
    benchmark::Initialize(&argc, argv);
    if (argc > 1) rt::scene() = rt::readMesh(argv[1]);
    rt::addAll();
    benchmark::RunSpecifiedBenchmarks();
    return 0;
}

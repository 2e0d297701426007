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

void buildStructure(benchmark::State& state, std::uint32_t structure, double voxelsPerTriangle) {
    BuildOptions options;
    options.structure = structure;
    options.resolution.voxelsPerTriangle = voxelsPerTriangle;
    for (auto _ : state) {
        StageTimer timer;
        const Atlas atlas = buildAtlas(scene(), "scene", options, timer);
        benchmark::DoNotOptimize(atlas.voxels.data());
    }
    countTriangles(state);
}

void buildUniform(benchmark::State& state) {
    buildStructure(state, kStructureUniform, kUniformVoxelsPerTriangle);
}

void buildCloud(benchmark::State& state) {
    buildStructure(state, kStructureCloud, kCloudVoxelsPerTriangle);
}

void buildNested(benchmark::State& state) {
    buildStructure(state, kStructureNested, kNestedVoxelsPerTriangle);
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

BENCHMARK(buildUniform)->Unit(benchmark::kMillisecond)->UseRealTime()->MeasureProcessCPUTime();
BENCHMARK(buildCloud)->Unit(benchmark::kMillisecond)->UseRealTime()->MeasureProcessCPUTime();
BENCHMARK(buildNested)->Unit(benchmark::kMillisecond)->UseRealTime()->MeasureProcessCPUTime();
BENCHMARK(buildEmbree)->Unit(benchmark::kMillisecond)->UseRealTime()->MeasureProcessCPUTime();

} // namespace
} // namespace rt

int main(int argc, char** argv) {
    benchmark::Initialize(&argc, argv);
    if (argc > 1) rt::scene() = rt::readMesh(argv[1]);
    benchmark::RunSpecifiedBenchmarks();
    return 0;
}

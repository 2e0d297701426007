#include "tools/rt-grid/forecast_build.h"

#include "tools/rt-grid/count_voxels.h"
#include "tools/rt-grid/forecast_bricks.h"
#include "tools/rt-grid/plan_grid.h"

#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>

namespace rt {
namespace {

constexpr std::uint64_t kAnyBuild = 2u << 20; // what the program grows by whatever it builds, measured
constexpr std::uint64_t kNestingThread =
    3u << 20; // what a thread of nestBricks() and growBoxes() keeps, measured

std::uint64_t workspaces() {
    return kNestingThread * static_cast<std::uint64_t>(tbb::this_task_arena::max_concurrency());
}

std::uint64_t rounded(double count) {
    return static_cast<std::uint64_t>(std::llround(count));
}

void setSizes(const MeshFile& meshFile, const GridStages& stages, BuildForecast& forecast) {
    const Mesh& mesh = meshFile.mesh;
    AtlasSizes& sizes = forecast.sizes;
    sizes.dims = stages.layout.dims;
    setScenery(sizes, mesh);
    sizes.vertices = mesh.positions.size();
    sizes.texcoords = showsImages(mesh) ? mesh.texcoords.size() : 0;
    sizes.images = stages.pages.places.size();
    sizes.pages = {stages.pages.width, stages.pages.height, stages.pages.pageCount};
}

// Bytes of lists while they are made: of the grid's, and of what nestBricks() makes of them. It keeps blocks
// of words until it moves them to where they belong, so these count twice.
struct ListBytes {
    std::uint64_t grid = 0;
    std::uint64_t nested = 0;
    std::uint64_t workspaces = 0; ///< of threads
};

// The most that is held at once: when the grid's lists are filled, when bricks are moved together, or at the
// end.
std::uint64_t peakOf(const AtlasSizes& sizes, std::uint64_t gridReferences, const ListBytes& lists) {
    const std::uint64_t voxels =
        std::uint64_t(sizes.dims.x) * sizes.dims.y * sizes.dims.z * sizeof(std::uint32_t);
    const std::uint64_t records = sizes.triangles * sizeof(TriangleRecord);
    const std::uint64_t perTriangle = sizes.triangles * sizeof(std::uint32_t); // of chunks of voxels
    const std::uint64_t binning =
        records + voxels + perTriangle + gridReferences * sizeof(std::uint32_t) + lists.grid;
    const std::uint64_t nesting = records + voxels + lists.grid + 2 * lists.nested + lists.workspaces;
    const std::uint64_t sharedWithMesh = sizes.texcoords * sizeof(glm::vec2);
    const std::uint64_t packing = fileBytesOf(sectionsOf(sizes)) - sharedWithMesh;
    return std::max({binning, lists.nested > 0 ? nesting : 0, packing}) + kAnyBuild;
}

// What a VDB file takes beside the atlas while it is made: its largest grid, in blocks of 8^3 voxels that may
// be partly empty, and its bytes. Measured.
std::uint64_t vdbBytesOf(const BuildForecast& forecast) {
    constexpr double kLibrary = 6e6;
    const AtlasSizes& sizes = forecast.sizes;
    const double voxels = double(sizes.dims.x) * double(sizes.dims.y) * double(sizes.dims.z);
    if (forecast.structure == kStructureUniform)
        return rounded(kLibrary +
                       std::min(4.3 * voxels, 35.0 * static_cast<double>(forecast.occupiedVoxels)));
    return rounded(kLibrary + 6.5 * voxels + 13.0 * static_cast<double>(sizes.brickWords));
}

// Of structures without bricks.
void forecastFlat(GridPlan& plan, std::uint32_t structure, const ReferenceLimit& limit,
                  BuildForecast& forecast) {
    const VoxelCount count = countVoxels(plan.stages.triangles, plan.stages.layout);
    forecast.occupiedVoxels = count.occupied;
    forecast.references = count.references;
    const std::uint64_t words = kListHeaderWords * count.occupied + count.references;
    forecast.sizes.referenceWords = words;
    const bool copied = structure == kStructureOctant; // by nestBricks()
    if (count.references + (copied ? words : 0) > limit.references) forecast.refusal = limit.message;
    const std::uint64_t bytes = words * sizeof(std::uint32_t);
    forecast.peakBytes =
        peakOf(forecast.sizes, count.references, {bytes, copied ? bytes : 0, copied ? workspaces() : 0});
}

void forecastNested(const GridPlan& plan, const CellRefs& refs, const ReferenceLimit& limit,
                    BuildForecast& forecast) {
    const NestedSize size = forecastBricks(refs, plan.stages.triangles, plan.stages.layout, plan.preset.nest);
    forecast.occupiedVoxels = rounded(size.leaves);
    forecast.references = rounded(size.referenceWords - kListHeaderWords * size.leaves);
    forecast.bricks = rounded(size.bricks);
    forecast.sizes.brickWords = rounded(size.brickWords);
    forecast.sizes.referenceWords = rounded(size.referenceWords);
    if (refs.referenceCount + rounded(size.budgetWords) > limit.references) forecast.refusal = limit.message;
    forecast.peakBytes =
        peakOf(forecast.sizes, refs.referenceCount,
               {refs.references.size() * sizeof(std::uint32_t),
                rounded(size.referenceWords + size.brickWords) * sizeof(std::uint32_t), workspaces()});
}

} // namespace

BuildForecast forecastBuild(const MeshFile& meshFile, const std::string& name, const BuildOptions& options,
                            StageTimer& timer) {
    timer.begin("rebase");
    GridPlan plan(meshFile.mesh, name, options);
    BuildForecast forecast;
    forecast.structure = options.structure.value_or(kStructureNested);
    timer.begin("bin");
    ReferenceLimit limit = plan.layOut(forecast.structure);
    CellRefs refs;
    if (forecast.structure == kStructureNested)
        refs = binTriangles(plan.stages.triangles, plan.stages.layout, limit, timer.meter());
    if (!options.structure) {
        forecast.choice = plan.choose(refs);
        if (forecast.choice->structure != forecast.structure && plan.fits(forecast.choice->structure)) {
            refs = CellRefs();
            limit = plan.layOut(forecast.structure = forecast.choice->structure);
        }
    }
    setSizes(meshFile, plan.stages, forecast);
    timer.begin("count");
    if (forecast.structure == kStructureNested)
        forecastNested(plan, refs, limit, forecast);
    else
        forecastFlat(plan, forecast.structure, limit, forecast);
    if (options.vdb)
        forecast.peakBytes =
            std::max(forecast.peakBytes, fileBytesOf(sectionsOf(forecast.sizes)) + vdbBytesOf(forecast));
    timer.end();
    return forecast;
}

} // namespace rt

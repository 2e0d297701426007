#include "tools/rt-grid/build_atlas.h"

#include "tools/rt-grid/grow_boxes.h"
#include "tools/rt-grid/grow_proximity.h"
#include "tools/rt-grid/pack_atlas.h"
#include "tools/rt-grid/plan_grid.h"

namespace rt {
namespace {

VoxelWords flatVoxels(CellRefs refs, std::uint32_t structure, const glm::uvec3& dims, StageTimer& timer) {
    if (structure == kStructureCloud) {
        timer.begin("proximity");
        refs.voxels = growProximity(std::move(refs.voxels), dims);
    }
    return {std::move(refs.voxels), {}, std::move(refs.references), refs.occupiedVoxels, refs.referenceCount};
}

// An octant structure is a nested one without bricks.
VoxelWords boxedVoxels(CellRefs refs, std::uint32_t structure, const GridStages& stages, NestOptions nest,
                       const ReferenceLimit& limit, StageTimer& timer) {
    if (structure == kStructureOctant) nest.maxDepth = 0;
    timer.begin("nest");
    NestedVoxels nested =
        nestBricks(std::move(refs), stages.triangles, stages.layout, nest, limit, timer.meter());
    timer.begin("boxes");
    growBoxes(nested, stages.layout.dims, nest.exitReach, timer.meter());
    return {std::move(nested.voxels), nested.bricks.share(), nested.references.share(), nested.occupiedVoxels,
            nested.referenceCount};
}

} // namespace

BuiltAtlas buildAtlas(const MeshFile& meshFile, const std::string& name, const BuildOptions& options,
                      StageTimer& timer) {
    timer.begin("rebase");
    GridPlan plan(meshFile.mesh, name, options);
    GridStages& stages = plan.stages;
    timer.begin("bin");
    std::uint32_t structure = options.structure.value_or(kStructureNested);
    ReferenceLimit limit = plan.layOut(structure);
    CellRefs refs = binTriangles(stages.triangles, stages.layout, limit, timer.meter());
    std::optional<StructureChoice> choice;
    if (!options.structure) {
        choice = plan.choose(refs);
        if (choice->structure != structure && plan.fits(choice->structure)) {
            refs = CellRefs(); // its memory is counted once
            limit = plan.layOut(structure = choice->structure);
            refs = binTriangles(stages.triangles, stages.layout, limit, timer.meter());
        }
    }
    stages.words = hasBoxes(structure)
                       ? boxedVoxels(std::move(refs), structure, stages, plan.preset.nest, limit, timer)
                       : flatVoxels(std::move(refs), structure, stages.layout.dims, timer);
    timer.begin("pack");
    Atlas atlas = packAtlas(meshFile, structure, std::move(stages));
    timer.end();
    return {std::move(atlas), choice};
}

} // namespace rt

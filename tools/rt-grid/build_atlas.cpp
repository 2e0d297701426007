#include "tools/rt-grid/build_atlas.h"

#include "tools/rt-grid/grow_boxes.h"
#include "tools/rt-grid/grow_proximity.h"
#include "tools/rt-grid/pack_atlas.h"

namespace rt {
namespace {

ReferenceLimit checkLimits(const Mesh& mesh, const std::string& name, const GridStages& stages,
                           const BuildOptions& options) {
    BuildSize size;
    size.dims = stages.layout.dims;
    size.triangles = mesh.triangles.size();
    size.vertices = mesh.positions.size();
    size.texels = stages.pages.texelCount();
    size.vdb = options.vdb;
    return checkLimits(name, size, options.memory);
}

VoxelWords flatVoxels(CellRefs refs, const BuildOptions& options, const glm::uvec3& dims, StageTimer& timer) {
    if (options.structure == kStructureCloud) {
        timer.begin("proximity");
        refs.voxels = growProximity(std::move(refs.voxels), dims);
    }
    return {std::move(refs.voxels), {}, std::move(refs.references), refs.occupiedVoxels, refs.referenceCount};
}

// An octant structure is a nested one without bricks.
VoxelWords boxedVoxels(CellRefs refs, const GridStages& stages, const BuildOptions& options,
                       const ReferenceLimit& limit, StageTimer& timer) {
    NestOptions nest = options.nest;
    if (options.structure == kStructureOctant) nest.maxDepth = 0;
    timer.begin("nest");
    NestedVoxels nested = nestBricks(std::move(refs), stages.triangles, stages.layout, nest, limit);
    timer.begin("boxes");
    growBoxes(nested, stages.layout.dims, nest.exitReach);
    return {std::move(nested.voxels), nested.bricks.share(), nested.references.share(), nested.occupiedVoxels,
            nested.referenceCount};
}

} // namespace

Atlas buildAtlas(const MeshFile& meshFile, const std::string& name, const BuildOptions& options,
                 StageTimer& timer) {
    const Mesh& mesh = meshFile.mesh;
    GridStages stages;
    timer.begin("rebase");
    stages.rebase = chooseRebase(boundsOf(mesh));
    stages.triangles = rebaseTriangles(mesh, stages.rebase);
    const BoundsD bounds = gridBounds(stages.triangles);
    const glm::uvec3 dims = chooseResolution(bounds.extent(), mesh.triangles.size(), options.resolution);
    stages.layout = placeGrid(bounds, dims);
    if (showsImages(mesh)) stages.pages = placeImages(mesh.images, name);
    const ReferenceLimit limit = checkLimits(mesh, name, stages, options);
    timer.begin("bin");
    CellRefs refs = binTriangles(stages.triangles, stages.layout, limit);
    stages.words = hasBoxes(options.structure) ? boxedVoxels(std::move(refs), stages, options, limit, timer)
                                               : flatVoxels(std::move(refs), options, dims, timer);
    timer.begin("pack");
    Atlas atlas = packAtlas(meshFile, options.structure, std::move(stages));
    timer.end();
    return atlas;
}

} // namespace rt

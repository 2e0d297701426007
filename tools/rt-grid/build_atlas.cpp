#include "tools/rt-grid/build_atlas.h"

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
    stages.refs = binTriangles(stages.triangles, stages.layout, limit);
    if (options.structure == kStructureCloud) {
        timer.begin("proximity");
        stages.refs.voxels = growProximity(std::move(stages.refs.voxels), dims);
    }
    timer.begin("pack");
    Atlas atlas = packAtlas(meshFile, options.structure, std::move(stages));
    timer.end();
    return atlas;
}

} // namespace rt

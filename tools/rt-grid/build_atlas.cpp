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

// Lays out the grid with which `structure` begins, and lists its voxels' triangles.
class Binning {
public:
    Binning(const Mesh& mesh, const std::string& name, const BuildOptions& options,
            const QualityPreset& preset, GridStages& stages)
        : mesh_(mesh), name_(name), options_(options), preset_(preset), stages_(stages),
          bounds_(gridBounds(stages.triangles)) {}

    CellRefs run(std::uint32_t structure) {
        ResolutionRequest request = options_.resolution;
        if (request.voxelsPerTriangle == 0.0)
            request.voxelsPerTriangle = preset_.voxelsPerTriangle(structure);
        const glm::uvec3 dims = chooseResolution(bounds_.extent(), mesh_.triangles.size(), request);
        stages_.layout = placeGrid(bounds_, dims);
        limit_ = checkLimits(mesh_, name_, stages_, options_);
        return binTriangles(stages_.triangles, stages_.layout, limit_);
    }
    const ReferenceLimit& limit() const { return limit_; }
    // How many voxels an octant structure would have for each of a nested one's.
    double octantVoxels() const {
        const ResolutionRequest& asked = options_.resolution;
        const bool isGiven = asked.voxelsPerTriangle > 0.0 || asked.longestSide > 0 || asked.exact.x > 0;
        return isGiven ? 1.0 : preset_.octantVoxelsPerTriangle / preset_.nestedVoxelsPerTriangle;
    }

private:
    const Mesh& mesh_;
    const std::string& name_;
    const BuildOptions& options_;
    const QualityPreset& preset_;
    GridStages& stages_;
    BoundsD bounds_;
    ReferenceLimit limit_;
};

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
    NestedVoxels nested = nestBricks(std::move(refs), stages.triangles, stages.layout, nest, limit);
    timer.begin("boxes");
    growBoxes(nested, stages.layout.dims, nest.exitReach);
    return {std::move(nested.voxels), nested.bricks.share(), nested.references.share(), nested.occupiedVoxels,
            nested.referenceCount};
}

} // namespace

BuiltAtlas buildAtlas(const MeshFile& meshFile, const std::string& name, const BuildOptions& options,
                      StageTimer& timer) {
    const Mesh& mesh = meshFile.mesh;
    QualityPreset preset = presetOf(options.quality);
    if (options.nest) preset.nest = *options.nest;
    GridStages stages;
    timer.begin("rebase");
    stages.rebase = chooseRebase(boundsOf(mesh));
    stages.triangles = rebaseTriangles(mesh, stages.rebase);
    if (showsImages(mesh)) stages.pages = placeImages(mesh.images, name);
    timer.begin("bin");
    Binning binning(mesh, name, options, preset, stages);
    std::uint32_t structure = options.structure.value_or(kStructureNested);
    CellRefs refs = binning.run(structure);
    std::optional<StructureChoice> choice;
    if (!options.structure) {
        choice = chooseStructure(refs, stages.triangles, stages.layout, preset.nest, binning.octantVoxels());
        if (choice->structure != structure) refs = binning.run(structure = choice->structure);
    }
    stages.words = hasBoxes(structure)
                       ? boxedVoxels(std::move(refs), structure, stages, preset.nest, binning.limit(), timer)
                       : flatVoxels(std::move(refs), structure, stages.layout.dims, timer);
    timer.begin("pack");
    Atlas atlas = packAtlas(meshFile, structure, std::move(stages));
    timer.end();
    return {std::move(atlas), choice};
}

} // namespace rt

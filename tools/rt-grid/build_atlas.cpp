#include "tools/rt-grid/build_atlas.h"

#include "tools/rt-grid/grow_boxes.h"
#include "tools/rt-grid/grow_proximity.h"
#include "tools/rt-grid/pack_atlas.h"

namespace rt {
namespace {

BuildSize sizeOf(const Mesh& mesh, const glm::uvec3& dims, std::uint32_t structure, const GridStages& stages,
                 const BuildOptions& options) {
    BuildSize size;
    size.dims = dims;
    size.triangles = mesh.triangles.size();
    size.vertices = mesh.positions.size();
    size.texels = stages.pages.texelCount();
    size.vdb = options.vdb;
    size.boxes = hasBoxes(structure);
    return size;
}

// Lays out the grid with which `structure` begins, and lists its voxels' triangles.
class Binning {
public:
    Binning(const Mesh& mesh, const std::string& name, const BuildOptions& options,
            const QualityPreset& preset, GridStages& stages)
        : mesh_(mesh), name_(name), options_(options), preset_(preset), stages_(stages),
          bounds_(gridBounds(stages.triangles)) {}

    CellRefs run(std::uint32_t structure) {
        stages_.layout = placeGrid(bounds_, dimsOf(structure), options_.padScale);
        limit_ = checkLimits(name_, sizeOf(mesh_, stages_.layout.dims, structure, stages_, options_),
                             options_.memory);
        return binTriangles(stages_.triangles, stages_.layout, limit_);
    }
    const ReferenceLimit& limit() const { return limit_; }
    bool fits(std::uint32_t structure) const {
        const BuildSize size = sizeOf(mesh_, dimsOf(structure), structure, stages_, options_);
        return voxelsOf(structure) <= double(kMaxVoxels) && forecastBytes(size) <= options_.memory.bytes;
    }
    // Voxels of the grid.
    double voxelsOf(std::uint32_t structure) const {
        const glm::dvec3 dims(dimsOf(structure));
        return dims.x * dims.y * dims.z;
    }

private:
    glm::uvec3 dimsOf(std::uint32_t structure) const {
        ResolutionRequest request = options_.resolution;
        if (request.voxelsPerTriangle == 0.0)
            request.voxelsPerTriangle = preset_.voxelsPerTriangle(structure);
        return chooseResolution(bounds_.extent(), mesh_.triangles.size(), request);
    }

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
    stages.worldBounds = sceneBounds(mesh);
    stages.rebase = chooseRebase(stages.worldBounds);
    stages.triangles = rebaseTriangles(mesh, stages.rebase);
    if (showsImages(mesh)) stages.pages = placeImages(mesh.images, name);
    timer.begin("bin");
    Binning binning(mesh, name, options, preset, stages);
    std::uint32_t structure = options.structure.value_or(kStructureNested);
    CellRefs refs = binning.run(structure);
    std::optional<StructureChoice> choice;
    if (!options.structure) {
        choice = chooseStructure(refs, stages.triangles, stages.layout, preset.nest,
                                 binning.voxelsOf(kStructureOctant) / binning.voxelsOf(structure));
        if (choice->structure != structure && binning.fits(choice->structure)) {
            refs = CellRefs(); // its memory is counted once
            refs = binning.run(structure = choice->structure);
        }
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

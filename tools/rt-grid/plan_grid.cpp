#include "tools/rt-grid/plan_grid.h"

namespace rt {
namespace {

QualityPreset presetFor(const BuildOptions& options) {
    QualityPreset preset = presetOf(options.quality);
    if (options.nest) preset.nest = *options.nest;
    return preset;
}

double countOf(const glm::uvec3& dims) {
    return double(dims.x) * double(dims.y) * double(dims.z);
}

} // namespace

GridPlan::GridPlan(const Mesh& mesh, const std::string& name, const BuildOptions& options)
    : preset(presetFor(options)), mesh_(mesh), name_(name), options_(options) {
    stages.worldBounds = sceneBounds(mesh);
    stages.rebase = chooseRebase(stages.worldBounds);
    stages.triangles = rebaseTriangles(mesh, stages.rebase);
    if (showsImages(mesh)) stages.pages = placeImages(mesh.images, name);
    bounds_ = gridBounds(stages.triangles);
}

ReferenceLimit GridPlan::layOut(std::uint32_t structure) {
    stages.layout = placeGrid(bounds_, dimsOf(structure), options_.padScale);
    return checkLimits(name_, sizeOf(structure), options_.memory);
}

StructureChoice GridPlan::choose(const CellRefs& nestedRefs) const {
    return chooseStructure(nestedRefs, stages.triangles, stages.layout, preset.nest,
                           countOf(dimsOf(kStructureOctant)) / countOf(dimsOf(kStructureNested)));
}

bool GridPlan::fits(std::uint32_t structure) const {
    return countOf(dimsOf(structure)) <= double(kMaxVoxels) &&
           forecastBytes(sizeOf(structure)) <= options_.memory.bytes;
}

glm::uvec3 GridPlan::dimsOf(std::uint32_t structure) const {
    ResolutionRequest request = options_.resolution;
    if (request.voxelsPerTriangle == 0.0) request.voxelsPerTriangle = preset.voxelsPerTriangle(structure);
    return chooseResolution(bounds_.extent(), mesh_.triangles.size(), request);
}

BuildSize GridPlan::sizeOf(std::uint32_t structure) const {
    BuildSize size;
    size.dims = dimsOf(structure);
    size.triangles = mesh_.triangles.size();
    size.vertices = mesh_.positions.size();
    size.texels = stages.pages.texelCount();
    size.vdb = options_.vdb;
    size.boxes = hasBoxes(structure);
    return size;
}

} // namespace rt

#pragma once
#include "tools/rt-grid/bin_triangles.h"
#include "tools/rt-grid/build_options.h"
#include "tools/rt-grid/choose_structure.h"
#include "tools/rt-grid/pack_atlas.h"

namespace rt {

/// What a build decides before it lists triangles, for builds and forecasts alike.
class GridPlan {
public:
    /// Rebases the triangles and places the images. `mesh`, `name` and `options` must outlive the plan.
    GridPlan(const Mesh& mesh, const std::string& name, const BuildOptions& options);

    /// Lays out the grid with which `structure` begins. Throws as checkLimits().
    ReferenceLimit layOut(std::uint32_t structure);
    /// Chooses a structure, given the lists of the grid laid out for nested.
    StructureChoice choose(const CellRefs& nestedRefs) const;
    /// Whether there is room for a structure, its lists not counted.
    bool fits(std::uint32_t structure) const;

    QualityPreset preset;
    GridStages stages;

private:
    glm::uvec3 dimsOf(std::uint32_t structure) const;
    BuildSize sizeOf(std::uint32_t structure) const;

    const Mesh& mesh_;
    const std::string& name_;
    const BuildOptions& options_;
    BoundsD bounds_;
};

} // namespace rt

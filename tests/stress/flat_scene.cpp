#include "tests/stress/flat_scene.h"

#include "tests/gpu/trace_fixture.h"
#include "tests/stress/stress_fixture.h"
#include "tests/support/make_mesh.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <cmath>

namespace rt::test {
namespace {

constexpr float kHalfFrame = 1.25f;

Mesh frame() {
    const glm::vec3 lo(-kHalfFrame), hi(kHalfFrame), x(0.01f, 0.0f, 0.0f), y(0.0f, 0.01f, 0.0f);
    return makeTriangles({lo, lo + x, lo + y, hi, hi - x, hi - y});
}

} // namespace

Mesh mapped(const Mesh& mesh, const MovePoint& move) {
    std::vector<glm::vec3> positions(mesh.positions.begin(), mesh.positions.end());
    for (glm::vec3& p : positions) p = move(p);
    Mesh result = mesh;
    result.positions = std::move(positions);
    return result;
}

Mesh innerPart(const Mesh& mesh, float reach) {
    std::vector<glm::uvec3> triangles;
    const auto isInner = [&](std::uint32_t vertex) {
        const glm::vec3 p = glm::abs(mesh.positions[vertex]);
        return p.x <= reach && p.y <= reach;
    };
    for (const glm::uvec3& t : mesh.triangles)
        if (isInner(t.x) && isInner(t.y) && isInner(t.z)) triangles.push_back(t);
    return makeIndexed({mesh.positions.begin(), mesh.positions.end()}, std::move(triangles));
}

FlatScene stack(const Mesh& sheet, const std::vector<float>& heights, float reach, const MovePoint& move,
                const glm::vec3& normal) {
    Mesh sheets = moved(sheet, 1.0f, {0.0f, 0.0f, heights[0]});
    for (std::size_t i = 1; i < heights.size(); ++i)
        sheets = joined(sheets, moved(sheet, 1.0f, {0.0f, 0.0f, heights[i]}));
    const float step = heights.size() > 1 ? heights[1] - heights[0] : 1.0f;
    return {joined(mapped(sheets, move), frame()), mapped(innerPart(sheets, reach), move), normal,
            step * glm::dot(normal, move({0.0f, 0.0f, 1.0f}) - move(glm::vec3(0.0f)))};
}

std::vector<float> voxelFaces(unsigned layers) {
    const GridParams grid = makeAtlas(frame(), kStructureUniform, glm::uvec3(layers)).grid;
    std::vector<float> faces;
    for (unsigned face = 2; face + 1 < layers; face += 2)
        faces.push_back((grid.gridLo.z + static_cast<float>(face) * grid.cellSize.z) / grid.worldOffset.w +
                        grid.worldOffset.z);
    return faces;
}

QueryRay rayAtSheet(const FlatScene& scene, const RayTargets& inner, RayNumbers& numbers) {
    const std::size_t kind = numbers.index(3);
    const glm::vec3 target = kind == 0   ? inner.vertex(numbers)
                             : kind == 1 ? inner.onEdge(numbers)
                                         : inner.onTriangle(numbers);
    // From steep to grazing: what is 2^-10 of the gap away sees the sheet at a thousandth of a degree or so.
    const float height = scene.gap * 0.9f * std::exp2(-10.0f * numbers.unit());
    const glm::vec3 aside = numbers.direction();
    const glm::vec3 inPlane = aside - scene.normal * glm::dot(aside, scene.normal);
    const float side = numbers.index(2) ? height : -height;
    return rayTowards(target + inPlane * numbers.unit() + scene.normal * side, target);
}

bool passesThrough(const QueryRay&, const QueryHit& hit, const QueryHitDouble*) {
    return isLost(hit) || distanceOf(hit) > 1.5f;
}

} // namespace rt::test

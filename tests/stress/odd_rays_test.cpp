// Rays that walks and tests have trouble with: along axes and diagonals, from the surface itself, from far
// away, and that end or begin where they hit.
#include "tests/stress/closed_mesh.h"
#include "tests/stress/double_referee.h"
#include "tests/stress/ray_targets.h"
#include "tests/stress/stress_fixture.h"
#include "tests/support/make_mesh.h"

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>

namespace rt {
namespace {

using test::ClosedMesh;
using test::rayFrom;
using test::RayNumbers;
using test::RayTargets;
using test::rayTowards;

constexpr std::uint32_t kStructures[] = {kStructureCloud, kStructureNested};

/// A closed mesh, its atlas, and where rays may start and go.
struct Scene {
    ClosedMesh closed;
    Atlas atlas;
    RayTargets targets;

    Scene(ClosedMesh mesh, std::uint32_t structure)
        : closed(std::move(mesh)), atlas(test::makeAtlas(closed.mesh, structure, {12, 11, 10})),
          targets(closed.mesh, atlas.grid) {
        closed.name += structure == kStructureCloud ? ", cloud" : ", nested";
    }
    glm::vec3 inside(RayNumbers& numbers) const {
        return closed.insides[numbers.index(closed.insides.size())];
    }
};

// Components that are nothing, next to nothing, alike or alone.
glm::vec3 oddDirection(RayNumbers& numbers) {
    constexpr float kOdd[] = {0.0f,    -0.0f, 1e-40f, -1e-40f, 1e-45f, -0x1p-126f, 1e-30f,
                              -1e-20f, 1e-8f, -1e-6f, 1.0f,    -1.0f,  1.0f,       -1.0f};
    glm::vec3 direction;
    for (int axis = 0; axis < 3; ++axis) direction[axis] = kOdd[numbers.index(std::size(kOdd))];
    const auto main = static_cast<int>(numbers.index(3));
    const float size = std::exp2(numbers.between(-60.0f, 60.0f));
    if (glm::length(direction) < 0.5f) direction[main] = numbers.index(2) ? 1.0f : -1.0f;
    return numbers.index(2) ? direction : direction * size;
}

class OddRays : public test::Stress {
protected:
    using MakeRayIn = std::function<QueryRay(const Scene&, RayNumbers&)>;

    static void expectNoLeak(const std::string& name, const MakeRayIn& makeRay) {
        for (const std::uint32_t structure : kStructures)
            for (const ClosedMesh& closed : {test::closedSphere(), test::closedTorus()}) {
                const Scene scene(closed, structure);
                expectNoneWrong({name + ", " + scene.closed.name, scene.atlas,
                                 [&](RayNumbers& numbers) { return makeRay(scene, numbers); }});
            }
    }
    static void expectAsInDouble(const std::string& name, const MakeRayIn& makeRay) {
        const Scene scene(test::closedTorus(), kStructureNested);
        const test::DoubleReferee referee(scene.closed.mesh, scene.atlas);
        expectNoneWrong({name + ", " + scene.closed.name, scene.atlas,
                         [&](RayNumbers& numbers) { return makeRay(scene, numbers); },
                         test::asInDouble(referee), "have a wrong hit", true});
    }
};

TEST_F(OddRays, OddDirectionsDoNotLeak) {
    expectNoLeak("directions of 0, -0, denormals and equals", [](const Scene& scene, RayNumbers& numbers) {
        const glm::vec3 origin = scene.inside(numbers);
        return rayFrom(origin, oddDirection(numbers));
    });
}

TEST_F(OddRays, OriginsOnVoxelFacesDoNotLeak) {
    expectNoLeak("origins on voxel faces", [](const Scene& scene, RayNumbers& numbers) {
        // At most half a voxel away: still inside.
        const glm::vec3 origin = scene.targets.toVoxelFaces(scene.inside(numbers), numbers);
        return numbers.index(2) ? rayFrom(origin, oddDirection(numbers))
                                : rayTowards(origin, scene.targets.any(numbers));
    });
}

TEST_F(OddRays, OriginsOnTheSurfaceDoNotLeak) {
    expectNoLeak("origins on faces, edges and vertices", [](const Scene& scene, RayNumbers& numbers) {
        const std::size_t kind = numbers.index(3);
        const glm::vec3 origin = kind == 0   ? scene.targets.vertex(numbers)
                                 : kind == 1 ? scene.targets.onEdge(numbers)
                                             : scene.targets.onTriangle(numbers);
        return rayTowards(origin, scene.inside(numbers));
    });
}

TEST_F(OddRays, OriginsOnTheSurfaceHitAsInDouble) {
    expectAsInDouble("origins on vertices and voxel faces", [](const Scene& scene, RayNumbers& numbers) {
        glm::vec3 origin = scene.targets.any(numbers);
        if (numbers.index(2)) origin = scene.targets.toVoxelFaces(origin, numbers);
        return rayFrom(origin, numbers.index(4) ? numbers.direction() : oddDirection(numbers));
    });
}

TEST_F(OddRays, OriginsOutsideHitAsInDouble) {
    expectAsInDouble("origins up to 1e6 diagonals away", [](const Scene& scene, RayNumbers& numbers) {
        const float away = scene.targets.diagonal() * std::pow(10.0f, numbers.between(0.0f, 6.0f));
        const glm::vec3 target = scene.targets.any(numbers);
        return rayTowards(target + numbers.direction() * away, target);
    });
}

// From so far away, floats cannot aim at much. But a ray through 0 can have any direction, if it starts a
// power of two times the direction away, and one along an axis can be anywhere.
QueryRay rayFromFar(RayNumbers& numbers) {
    const float away = std::exp2(std::floor(numbers.between(1.0f, 32.0f)));
    if (numbers.index(2)) {
        const glm::vec3 direction = glm::normalize(numbers.direction());
        return rayFrom(-away * direction, direction);
    }
    const auto axis = static_cast<int>(numbers.index(3));
    glm::vec3 direction(0.0f);
    direction[axis] = numbers.index(2) ? 1.0f : -1.0f;
    glm::vec3 origin = numbers.direction() * 0.5f; // meets the sphere of radius 1
    origin[axis] = -away * direction[axis];
    return rayFrom(origin, direction);
}

TEST_F(OddRays, OriginsUpTo1e9DiagonalsAwayDoNotMissASphere) {
    for (const std::uint32_t structure : kStructures) {
        const Scene scene(test::closedSphere(), structure);
        expectNoneWrong({"origins up to 1e9 diagonals away, " + scene.closed.name, scene.atlas, rayFromFar});
    }
}

TEST_F(OddRays, OriginsUpTo1e9DiagonalsAwayHitAsInDouble) {
    expectAsInDouble("origins up to 1e9 diagonals away",
                     [](const Scene&, RayNumbers& numbers) { return rayFromFar(numbers); });
}

// Each coordinate 0 or, with either sign, from 1e30 to the largest float; half of the rays go back to (0, 0,
// 0).
QueryRay rayFromTheEndOfFloats(RayNumbers& numbers) {
    const auto powerOfTen = [&](float lo, float hi) { return std::pow(10.0f, numbers.between(lo, hi)); };
    const auto far = [&] {
        return numbers.index(4) ? powerOfTen(30.0f, 38.0f) : std::numeric_limits<float>::max();
    };
    glm::vec3 signs;
    for (int axis = 0; axis < 3; ++axis) signs[axis] = static_cast<float>(numbers.index(3)) - 1.0f;
    if (signs == glm::vec3(0.0f)) signs.x = 1.0f;
    glm::vec3 origin = signs * far();
    if (numbers.index(2))
        for (int axis = 0; axis < 3; ++axis) origin[axis] = signs[axis] * far();
    const glm::vec3 sizes = glm::abs(origin);
    const glm::vec3 back = -origin / std::max({sizes.x, sizes.y, sizes.z});
    const glm::vec3 direction = numbers.index(2) ? back : numbers.direction();
    return rayFrom(origin, direction * (numbers.index(2) ? 1.0f : powerOfTen(-30.0f, 30.0f)));
}

bool isCutShortOrNotFinite(const QueryRay&, const QueryHit& hit, const QueryHitDouble*) {
    if (hit.tuvId.w == kNoTriangle) return false;
    return hit.tuvId.w == kWalkCutShort || !std::isfinite(test::distanceOf(hit)) ||
           !std::isfinite(std::bit_cast<float>(hit.tuvId.y)) ||
           !std::isfinite(std::bit_cast<float>(hit.tuvId.z));
}

// What they hit is left open: floats that far apart cannot aim.
TEST_F(OddRays, WalksFromTheEndOfFloatsEnd) {
    constexpr unsigned kPart = 20; // a walk that does not end takes as long as thousands of others
    for (const std::uint32_t structure : kStructures)
        for (const test::Placement& placement : {test::kPlacements[0], test::kPlacements[1]}) {
            const Scene scene(placement.of(test::closedSphere()), structure);
            expectNoneWrong({"origins of 1e30 and more, " + scene.closed.name, scene.atlas,
                             rayFromTheEndOfFloats, isCutShortOrNotFinite,
                             "are cut short or have a hit that is not finite", false, kPart});
        }
}

// Rays that end or begin at a hit, one float before it or one after it.
class Limits : public OddRays {
protected:
    static std::size_t count() { return std::min<std::size_t>(test::raysPerCase() / 4, 1'000'000); }

    /// What a ray with other limits should find.
    enum class Expected { SameHit, NoHit, LaterHit };
    struct Limit {
        const char* name;
        float tMin, tMax;
        Expected expected;
    };
    static std::vector<Limit> limitsAt(float t) {
        const float before = std::nextafter(t, 0.0f);
        const float after = std::nextafter(t, test::kNoEnd);
        return {{"[t, t]", t, t, Expected::SameHit},
                {"[0, t]", 0.0f, t, Expected::SameHit},
                {"[t, end]", t, test::kNoEnd, Expected::SameHit},
                {"[before t, t]", before, t, Expected::SameHit},
                {"[t, after t]", t, after, Expected::SameHit},
                {"[0, before t]", 0.0f, before, Expected::NoHit},
                {"[after t, end]", after, test::kNoEnd, Expected::LaterHit}};
    }
    static bool isAsExpected(const QueryHit& hit, const QueryHit& whole, Expected expected) {
        switch (expected) {
        case Expected::SameHit:
            return hit.tuvId == whole.tuvId;
        case Expected::NoHit:
            return hit.tuvId.w == kNoTriangle;
        default:
            return hit.tuvId.w == kNoTriangle || test::distanceOf(hit) > test::distanceOf(whole);
        }
    }
    /// Lines of what was not as expected, one for each kind of limits.
    static void expectClosedIntervals(const char* name, const Scene& scene, const MakeRayIn& makeRay) {
        std::vector<QueryRay> rays;
        for (std::size_t i = 0; i < count(); ++i) {
            RayNumbers numbers(9, i);
            rays.push_back(makeRay(scene, numbers));
        }
        const auto whole = test::traceQuery(*context, scene.atlas, rays);
        for (std::size_t limit = 0; limit < limitsAt(1.0f).size(); ++limit) {
            std::vector<QueryRay> limited = rays;
            for (std::size_t i = 0; i < count(); ++i) {
                const Limit l = limitsAt(test::distanceOf(whole[i]))[limit];
                limited[i].originTmin.w = l.tMin, limited[i].directionTmax.w = l.tMax;
            }
            const auto hits = test::traceQuery(*context, scene.atlas, limited);
            std::size_t wrong = 0, traced = 0;
            for (std::size_t i = 0; i < count(); ++i) {
                if (!(test::distanceOf(whole[i]) > 0.0f)) continue; // a miss
                const Limit l = limitsAt(test::distanceOf(whole[i]))[limit];
                ++traced, wrong += !isAsExpected(hits[i], whole[i], l.expected);
            }
            const char* const interval = limitsAt(1.0f)[limit].name;
            fmt::print("t in {}, {}, {}, watertight: {} of {} rays have another hit\n", interval, name,
                       scene.closed.name, wrong, traced);
            EXPECT_EQ(wrong, 0u) << interval << ", " << name;
        }
    }
};

TEST_F(Limits, RaysFromInsideMayEndAndBeginAtTheirHit) {
    expectClosedIntervals("from inside", Scene(test::closedTorus(), kStructureNested),
                          [](const Scene& scene, RayNumbers& numbers) {
                              const glm::vec3 origin = scene.inside(numbers);
                              return rayTowards(origin, scene.targets.any(numbers));
                          });
}

TEST_F(Limits, RaysFromOutsideMayEndAndBeginAtTheirHit) {
    expectClosedIntervals("from outside", Scene(test::closedTorus(), kStructureNested),
                          [](const Scene& scene, RayNumbers& numbers) {
                              const float away = std::pow(10.0f, numbers.between(0.5f, 4.0f));
                              const glm::vec3 origin = numbers.direction() * away;
                              return rayTowards(origin, scene.targets.any(numbers));
                          });
}

} // namespace
} // namespace rt

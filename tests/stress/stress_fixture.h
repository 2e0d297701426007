#pragma once
#include "tests/gpu/trace_fixture.h"
#include "tests/support/split_mix.h"

#include <bit>
#include <functional>
#include <memory>
#include <string>

namespace rt::test {

/// $RT_STRESS_RAYS, or few enough for CI.
std::uint64_t raysPerCase();

using MakeRay = std::function<QueryRay(RayNumbers&)>;
/// `reference` is null where none was asked for.
using IsWrong = std::function<bool(const QueryRay&, const QueryHit&, const QueryHitDouble* reference)>;

/// The ray has left a mesh that it cannot leave.
inline bool isLost(const QueryHit& hit) {
    return hit.tuvId.w == kNoTriangle || hit.tuvId.w == kWalkCutShort;
}
inline bool leaks(const QueryRay&, const QueryHit& hit, const QueryHitDouble*) {
    return isLost(hit);
}
inline float distanceOf(const QueryHit& hit) {
    return std::bit_cast<float>(hit.tuvId.x);
}

/// Rays for an atlas, and what is wrong about a hit.
struct StressCase {
    std::string name;
    const Atlas& atlas;
    MakeRay makeRay;
    IsWrong isWrong = leaks;
    std::string fault = "leak"; ///< "N of M rays leak"
    bool hasReference = false;  ///< in double precision
    unsigned part = 1;  ///< only so many times fewer rays, where each is tested against hundreds of triangles
    unsigned times = 1; ///< so many times more rays
};

/// What one triangle test made of a case.
struct Tally {
    std::uint64_t rays = 0;  ///< by each kernel
    std::uint64_t wrong = 0; ///< of them
    std::string firstWrong;  ///< as text
};

/// Cases with as many rays as raysPerCase() says, in batches: an atlas is uploaded and a program compiled
/// once, and the rays are made on all cores from their numbers.
class Stress : public OnGpu {
protected:
    static void TearDownTestSuite() {
        programs_.reset();
        OnGpu::TearDownTestSuite();
    }

    /// Traced by both kernels, whose hits must be the same to the bit.
    static Tally watertight(const StressCase& stress);
    /// Judges the watertight test; the rates of the other tests, by the plain kernel, are printed only.
    static void expectNoneWrong(const StressCase& stress);
    /// Prints one line.
    static void report(const StressCase& stress, const char* test, const Tally& tally);
    /// The rate of a test that is not judged.
    static Tally measured(const StressCase& stress, unsigned intersect);

private:
    class Run;
    static ProgramCache& programs();
    static inline std::unique_ptr<ProgramCache> programs_;
};

} // namespace rt::test

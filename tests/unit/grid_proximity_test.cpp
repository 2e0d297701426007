#include "formats/atlas.shared.h"
#include "tools/rt-grid/grow_proximity.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cstdlib>
#include <random>

namespace rt {
namespace {

std::vector<std::uint32_t> randomVoxels(const glm::uvec3& dims, unsigned oneIn, std::mt19937& random) {
    std::vector<std::uint32_t> voxels(std::size_t(dims.x) * dims.y * dims.z, 0u);
    for (std::uint32_t& word : voxels)
        if (random() % oneIn == 0) word = kOccupiedBit | static_cast<std::uint32_t>(random() >> 1);
    voxels[random() % voxels.size()] = kOccupiedBit;
    return voxels;
}

// The definition itself, voxel against voxel.
std::vector<std::uint32_t> bruteForce(const std::vector<std::uint32_t>& voxels, const glm::uvec3& dims) {
    const auto at = [&](std::size_t i) {
        return glm::ivec3(i % dims.x, i / dims.x % dims.y, i / dims.x / dims.y);
    };
    std::vector<glm::ivec3> occupied;
    for (std::size_t i = 0; i < voxels.size(); ++i)
        if (voxels[i] & kOccupiedBit) occupied.push_back(at(i));
    std::vector<std::uint32_t> result = voxels;
    for (std::size_t i = 0; i < voxels.size(); ++i) {
        if (voxels[i] & kOccupiedBit) continue;
        result[i] = ~0u;
        for (const glm::ivec3& o : occupied) {
            const glm::ivec3 d = at(i) - o;
            result[i] =
                std::min(result[i],
                         static_cast<std::uint32_t>(std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)})));
        }
    }
    return result;
}

TEST(GridProximity, equalsBruteForceOnRandomOccupancies) {
    std::mt19937 random(1);
    for (const glm::uvec3 dims : {glm::uvec3(1, 1, 1), glm::uvec3(17, 1, 1), glm::uvec3(1, 13, 1),
                                  glm::uvec3(1, 1, 19), glm::uvec3(9, 11, 1), glm::uvec3(1, 9, 15),
                                  glm::uvec3(13, 7, 11), glm::uvec3(5, 41, 3), glm::uvec3(15, 15, 15)})
        for (const unsigned oneIn : {2u, 20u, 300u, 1u << 30}) {
            const std::vector<std::uint32_t> voxels = randomVoxels(dims, oneIn, random);
            EXPECT_EQ(growProximity(voxels, dims), bruteForce(voxels, dims))
                << dims.x << "x" << dims.y << "x" << dims.z << ", one in " << oneIn;
        }
}

TEST(GridProximity, reachesAcrossALargeEmptyGrid) {
    const glm::uvec3 dims(3, 70, 300);
    std::vector<std::uint32_t> voxels(std::size_t(dims.x) * dims.y * dims.z, 0u);
    voxels[0] = kOccupiedBit;
    EXPECT_EQ(growProximity(voxels, dims).back(), 299u);
}

TEST(GridProximity, doesNotDependOnTheNumberOfThreads) {
    const tbb::global_control allowed(tbb::global_control::max_allowed_parallelism,
                                      4); // on small machines too
    std::mt19937 random(2);
    const glm::uvec3 dims(61, 83, 37);
    const std::vector<std::uint32_t> voxels = randomVoxels(dims, 2000, random);
    tbb::task_arena one(1);
    tbb::task_arena four(4);
    EXPECT_EQ(one.execute([&] { return growProximity(voxels, dims); }),
              four.execute([&] { return growProximity(voxels, dims); }));
}

} // namespace
} // namespace rt

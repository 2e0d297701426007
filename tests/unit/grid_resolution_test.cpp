#include "common/error.h"
#include "tools/rt-grid/choose_resolution.h"
#include "tools/rt-grid/options.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

namespace rt {
namespace {

glm::uvec3 byDensity(const glm::dvec3& extent, std::size_t triangles, double density) {
    ResolutionRequest request;
    request.voxelsPerTriangle = density;
    return chooseResolution(extent, triangles, request);
}

glm::uvec3 byText(const glm::dvec3& extent, const std::string& text) {
    ResolutionRequest request;
    parseResolution(text, request);
    return chooseResolution(extent, 1000, request);
}

ErrorKind kindOf(const std::function<void()>& body) {
    try {
        body();
    } catch (const Error& error) {
        return error.kind();
    }
    return ErrorKind::Internal;
}

TEST(GridResolution, oneNumberIsTheLongestSideOfCubicVoxels) {
    EXPECT_EQ(byText({1.0, 0.5, 0.25}, "256"), glm::uvec3(256, 128, 64));
    EXPECT_EQ(byText({0.1, 0.3, 0.2}, "9"), glm::uvec3(3, 9, 6));
    EXPECT_EQ(byText({1.0, 1e-3, 1e-3}, "100"), glm::uvec3(100, 1, 1));
    EXPECT_EQ(byText({1.0, 1.0, 1.0}, "1"), glm::uvec3(1, 1, 1));
}

TEST(GridResolution, threeNumbersAreTakenAsTheyAre) {
    EXPECT_EQ(byText({1.0, 0.5, 0.25}, "4x256x32"), glm::uvec3(4, 256, 32));
    EXPECT_EQ(byText({1.0, 0.5, 0.25}, "65536x1x1"), glm::uvec3(65536, 1, 1));
}

TEST(GridResolution, refusesWhatIsNotASizeOrTooLarge) {
    for (const char* text : {"0", "4x4", "4x4x4x4", "-1", "4x0x4", "x", "1.5", " 4", "4x4x", "99999999999"})
        EXPECT_EQ(kindOf([&] { byText(glm::dvec3(1.0), text); }), ErrorKind::Usage) << text;
    EXPECT_EQ(kindOf([] { byText(glm::dvec3(1.0), "65537"); }), ErrorKind::LimitExceeded);
    EXPECT_EQ(kindOf([] { byText(glm::dvec3(1.0), "1x1x65537"); }), ErrorKind::LimitExceeded);
}

TEST(GridResolution, densityGivesThatManyNearlyCubicVoxels) {
    for (const glm::dvec3 extent :
         {glm::dvec3(1.0, 1.0, 1.0), glm::dvec3(1.0, 0.7, 0.45), glm::dvec3(0.2, 0.9, 0.5)})
        for (const double density : {1.0, 4.0, 16.0, 64.0}) {
            const glm::uvec3 dims = byDensity(extent, 50000, density);
            const double voxels = double(dims.x) * dims.y * dims.z;
            EXPECT_NEAR(voxels / (density * 50000), 1.0, 0.1);
            const glm::dvec3 cell = extent / glm::dvec3(dims);
            EXPECT_LT(std::max({cell.x, cell.y, cell.z}) / std::min({cell.x, cell.y, cell.z}), 1.1);
        }
}

TEST(GridResolution, densitySpendsAllVoxelsInTheLongAxesOfThinScenes) {
    const glm::uvec3 flat = byDensity({1.0, 1.0, 1e-3}, 2500, 4.0);
    EXPECT_EQ(flat, glm::uvec3(100, 100, 1));
    EXPECT_EQ(byDensity({1e-3, 1.0, 1e-3}, 25, 4.0), glm::uvec3(1, 100, 1));
}

TEST(GridResolution, densityStaysWithinOneAnd1024PerAxis) {
    EXPECT_EQ(byDensity(glm::dvec3(1.0), 1, 1e-6), glm::uvec3(1));
    EXPECT_EQ(byDensity({1.0, 1.0, 1e-5}, 100'000'000, 16.0), glm::uvec3(1024, 1024, 1));
    const glm::uvec3 most = byDensity(glm::dvec3(1.0), 2'000'000'000, 1e9);
    EXPECT_LE(double(most.x) * most.y * most.z, kMaxAutomaticVoxels * 1.01);
}

} // namespace
} // namespace rt

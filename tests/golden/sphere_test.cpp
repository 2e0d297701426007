// A sphere lit by one point light, computed analytically, against the whole chain of tools.
#include "formats/image_exr.h"
#include "formats/mesh_file.h"
#include "tests/support/make_mesh.h"
#include "tests/support/run_command.h"
#include "tests/support/temporary_folder.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <optional>

namespace rt {
namespace {

constexpr std::uint32_t kSize = 256;
constexpr double kFovDegrees = 40.0;
const glm::dvec3 kEye(0.5, 0.4, 4.0);
const glm::dvec3 kLight(-3.0, 4.0, 5.0);
const glm::dvec3 kIntensity(60.0, 45.0, 30.0);
const glm::dvec3 kBackground(0.1, 0.2, 0.3);

glm::dvec3 pixelDirection(double x, double y) {
    const glm::dvec3 forward = glm::normalize(-kEye);
    const glm::dvec3 right = glm::normalize(glm::cross(forward, glm::dvec3(0, 1, 0)));
    const glm::dvec3 up = glm::cross(right, forward);
    const double half = std::tan(kFovDegrees * M_PI / 360.0);
    return glm::normalize(forward + right * half * (2 * x / kSize - 1) + up * half * (1 - 2 * y / kSize));
}

// Where the ray from the eye first meets the unit sphere at the origin.
std::optional<glm::dvec3> sphereHit(const glm::dvec3& direction) {
    const double b = glm::dot(kEye, direction);
    const double discriminant = b * b - glm::dot(kEye, kEye) + 1.0;
    if (discriminant < 0.0) return std::nullopt;
    return kEye + direction * (-b - std::sqrt(discriminant));
}

glm::dvec3 radiance(const glm::dvec3& point, double albedo) {
    const glm::dvec3 toLight = kLight - point;
    const double squaredDistance = glm::dot(toLight, toLight);
    const double cosine = glm::dot(point, toLight) / std::sqrt(squaredDistance);
    return cosine > 0.0 ? kIntensity * (albedo / M_PI * cosine / squaredDistance) : glm::dvec3(0.0);
}

Image analyticSphere(double albedo) {
    Image image;
    image.width = image.height = kSize;
    for (const char* name : {"A", "B", "G", "R", "Z"})
        image.channels.push_back({name, ImageChannel::Type::Float, std::vector<float>(kSize * kSize), {}});
    for (std::uint32_t i = 0; i < kSize * kSize; ++i) {
        const glm::dvec3 direction = pixelDirection(i % kSize + 0.5, i / kSize + 0.5);
        const auto hit = sphereHit(direction);
        const glm::dvec3 color = hit ? radiance(*hit, albedo) : kBackground;
        image.channels[0].values[i] = hit ? 1.0f : 0.0f;
        for (int c = 0; c < 3; ++c) image.channels[3 - c].values[i] = static_cast<float>(color[c]);
        if (hit)
            image.channels[4].values[i] = static_cast<float>(glm::dot(*hit - kEye, glm::normalize(-kEye)));
    }
    return image;
}

std::string tool(const char* name) {
    return std::string(RT_BIN_DIR) + "/" + name;
}

class GoldenSphere : public testing::TestWithParam<const char*> {};

TEST_P(GoldenSphere, RenderAgreesWithTheFormula) {
    const test::TemporaryFolder folder;
    const Mesh mesh = test::makeSphere(6);
    writeMesh(folder.file("s.rtmesh"), mesh);
    const Image golden = analyticSphere(mesh.materials[0].baseColor.r);
    writeImage(folder.file("golden.exr"), golden);
    const auto grid =
        test::runCommand({tool("rt-grid"), folder.file("s.rtmesh"), "-o", folder.file("s.rtatlas"),
                          "--structure", GetParam(), "--resolution", "64"});
    ASSERT_EQ(grid.exitCode, 0) << grid.err;
    const auto trace = test::runCommand({tool("rt-trace"),
                                         folder.file("s.rtatlas"),
                                         "-o",
                                         folder.file("s.exr"),
                                         "--size",
                                         "256x256",
                                         "--eye",
                                         "0.5,0.4,4",
                                         "--look-at",
                                         "0,0,0",
                                         "--up",
                                         "0,1,0",
                                         "--fov",
                                         "40",
                                         "--light",
                                         "-3,4,5,60,45,30",
                                         "--ambient",
                                         "0",
                                         "--background",
                                         "0.1,0.2,0.3",
                                         "--device",
                                         "software"});
    ASSERT_EQ(trace.exitCode, 0) << trace.err;

    const Image render = readExr(folder.file("s.exr"));
    int compared = 0;
    for (std::uint32_t i = 0; i < kSize * kSize; ++i) {
        const auto hit = sphereHit(pixelDirection(i % kSize + 0.5, i / kSize + 0.5));
        const bool grazing = hit && (glm::dot(*hit, glm::normalize(kEye - *hit)) < 0.1 ||
                                     std::abs(glm::dot(*hit, glm::normalize(kLight - *hit))) < 0.03);
        if (!hit || grazing) continue;
        ++compared;
        for (const char* channel : {"R", "G", "B"})
            ASSERT_NEAR(render.find(channel)->values[i], golden.find(channel)->values[i], 2e-3)
                << channel << " of pixel " << i;
        ASSERT_NEAR(render.find("Z")->values[i], golden.find("Z")->values[i], 1e-3) << "Z of pixel " << i;
        ASSERT_EQ(render.find("A")->values[i], 1.0f);
    }
    EXPECT_GT(compared, 15000);
    // The outline is a polygon's, so a few of its pixels may be on the other side.
    double squaredError = 0.0;
    for (std::uint32_t i = 0; i < kSize * kSize; ++i)
        squaredError += std::pow(render.find("A")->values[i] - golden.find("A")->values[i], 2);
    EXPECT_LE(squaredError, 8.0) << "pixels of the outline that differ";
}

INSTANTIATE_TEST_SUITE_P(Structures, GoldenSphere, testing::Values("uniform", "cloud", "nested"));

} // namespace
} // namespace rt

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
constexpr const char* kColors[] = {"R", "G", "B"};

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

void renderSphere(const test::TemporaryFolder& folder, const char* structure) {
    const auto grid =
        test::runCommand({tool("rt-grid"), folder.file("s.rtmesh"), "-o", folder.file("s.rtatlas"),
                          "--structure", structure, "--resolution", "64"});
    ASSERT_EQ(grid.exitCode, 0) << grid.err;
    std::vector<std::string> arguments{tool("rt-trace"), folder.file("s.rtatlas"), "-o",
                                       folder.file("s.exr")};
    for (const char* argument : {"--size", "256x256", "--eye", "0.5,0.4,4", "--look-at", "0,0,0", "--up",
                                 "0,1,0", "--fov", "40", "--light", "-3,4,5,60,45,30", "--ambient", "0",
                                 "--background", "0.1,0.2,0.3", "--device", "software"})
        arguments.push_back(argument);
    const auto trace = test::runCommand(arguments);
    ASSERT_EQ(trace.exitCode, 0) << trace.err;
}

// The polygons lie inside the sphere: a ray that misses it sees the background, exactly.
void expectBackground(const Image& render, std::uint32_t i) {
    for (int c = 0; c < 3; ++c)
        ASSERT_EQ(render.find(kColors[c])->values[i], static_cast<float>(kBackground[c])) << "pixel " << i;
    ASSERT_EQ(render.find("A")->values[i], 0.0f) << "pixel " << i;
    ASSERT_EQ(render.find("id")->uints[i], 0xFFFFFFFFu) << "pixel " << i;
}

void expectSphere(const Image& render, const Image& golden, std::uint32_t i) {
    for (const char* channel : kColors)
        ASSERT_NEAR(render.find(channel)->values[i], golden.find(channel)->values[i], 2e-3)
            << channel << " of pixel " << i;
    ASSERT_NEAR(render.find("Z")->values[i], golden.find("Z")->values[i], 1e-3) << "pixel " << i;
    ASSERT_EQ(render.find("A")->values[i], 1.0f) << "pixel " << i;
}

// Pixel by pixel, except where the polygons' edge or the limit of the light make a step in the picture.
void expectPixels(const Image& render, const Image& golden) {
    int sphereCount = 0, backgroundCount = 0;
    for (std::uint32_t i = 0; i < kSize * kSize && !testing::Test::HasFatalFailure(); ++i) {
        const auto hit = sphereHit(pixelDirection(i % kSize + 0.5, i / kSize + 0.5));
        const bool grazing = hit && (glm::dot(*hit, glm::normalize(kEye - *hit)) < 0.1 ||
                                     std::abs(glm::dot(*hit, glm::normalize(kLight - *hit))) < 0.03);
        if (grazing) continue;
        ++(hit ? sphereCount : backgroundCount);
        hit ? expectSphere(render, golden, i) : expectBackground(render, i);
    }
    EXPECT_GT(sphereCount, 15000);
    EXPECT_GT(backgroundCount, 15000);
}

class GoldenSphere : public testing::TestWithParam<const char*> {};

TEST_P(GoldenSphere, RenderAgreesWithTheFormula) {
    const test::TemporaryFolder folder;
    const Mesh mesh = test::makeSphere(6);
    writeMesh(folder.file("s.rtmesh"), mesh);
    ASSERT_NO_FATAL_FAILURE(renderSphere(folder, GetParam()));
    Image render = readExr(folder.file("s.exr"));
    const Image golden = analyticSphere(mesh.materials[0].baseColor.r);
    expectPixels(render, golden);

    // The formula has no normals, triangle ids and camera, which rt-compare misses where only one picture has
    // them.
    std::erase_if(render.channels, [&](const ImageChannel& channel) { return !golden.find(channel.name); });
    writeImage(folder.file("render.exr"), render);
    writeImage(folder.file("golden.exr"), golden);
    const auto compare =
        test::runCommand({tool("rt-compare"), folder.file("render.exr"), folder.file("golden.exr"),
                          "--max-rmse", "1e-4", "--allow", "camera"});
    EXPECT_EQ(compare.exitCode, 0) << compare.out << compare.err;
}

INSTANTIATE_TEST_SUITE_P(Structures, GoldenSphere, testing::Values("uniform", "cloud", "octant", "nested"));

} // namespace
} // namespace rt

// The way of the thesis: a 3DS file of 20 polygons with a light and a camera, written byte by byte as its
// format has it, imported, gridded and rendered. What is where in the picture follows from the file alone.
#include "formats/image_exr.h"
#include "tests/support/run_command.h"
#include "tests/support/temporary_folder.h"

#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <glm/vec3.hpp>
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <fstream>

namespace rt {
namespace {

using testing::HasSubstr;

template <class T>
std::string bytesOf(const T& value) {
    return {reinterpret_cast<const char*>(&value), sizeof(T)};
}

std::string chunk(std::uint16_t id, const std::string& content) {
    return bytesOf(id) + bytesOf(static_cast<std::uint32_t>(content.size() + 6)) + content;
}

std::string text(const std::string& name) {
    return name + '\0';
}

std::string material(const std::string& name, const glm::vec3& color) {
    const std::string floats = bytesOf(color);
    return chunk(0xAFFF, chunk(0xA000, text(name)) + chunk(0xA020, chunk(0x0010, floats)));
}

std::string object(const std::string& name, const std::string& content) {
    return chunk(0x4000, text(name) + content);
}

std::string mesh(const std::vector<glm::vec3>& vertices, const std::vector<glm::uvec3>& faces,
                 const std::string& materialName) {
    std::string points = bytesOf(static_cast<std::uint16_t>(vertices.size()));
    for (const glm::vec3& v : vertices) points += bytesOf(v);
    std::string list = bytesOf(static_cast<std::uint16_t>(faces.size()));
    std::string group = text(materialName) + bytesOf(static_cast<std::uint16_t>(faces.size()));
    for (std::uint16_t i = 0; i < faces.size(); ++i) {
        for (int k = 0; k < 3; ++k) list += bytesOf(static_cast<std::uint16_t>(faces[i][k]));
        list += bytesOf(std::uint16_t(7)); // all edges can be seen
        group += bytesOf(i);
    }
    return chunk(0x4100, chunk(0x4110, points) + chunk(0x4120, list + chunk(0x4130, group)));
}

// The author's scene: z is up. A grey floor, a red box of side 2 on the left, a blue pyramid on the right.
const glm::vec3 kEye(0, -14, 5), kTarget(0, 0, 1), kLight(8, -6, 10);
constexpr float kLensMm = 35.0f;

std::string floorMesh() {
    return mesh({{-6, -5, 0}, {6, -5, 0}, {6, 5, 0}, {-6, 5, 0}}, {{0, 1, 2}, {0, 2, 3}}, "grey");
}

std::string boxMesh() {
    std::vector<glm::vec3> corners;
    for (int i = 0; i < 8; ++i)
        corners.emplace_back(-4 + 2 * (i & 1), -1 + 2 * (i >> 1 & 1), 2 * (i >> 2 & 1));
    return mesh(corners,
                {{0, 2, 3},
                 {0, 3, 1},
                 {4, 5, 7},
                 {4, 7, 6},
                 {0, 1, 5},
                 {0, 5, 4},
                 {2, 6, 7},
                 {2, 7, 3},
                 {0, 4, 6},
                 {0, 6, 2},
                 {1, 3, 7},
                 {1, 7, 5}},
                "red");
}

std::string pyramidMesh() {
    return mesh({{2, -1, 0}, {4, -1, 0}, {4, 1, 0}, {2, 1, 0}, {3, 0, 3}},
                {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}, {0, 2, 1}, {0, 3, 2}}, "blue");
}

std::string sceneFile(float bankDegrees) {
    const std::string light =
        object("lamp", chunk(0x4600, bytesOf(kLight) + chunk(0x0010, bytesOf(glm::vec3(1.0f)))));
    const std::string camera = object(
        "view", chunk(0x4700, bytesOf(kEye) + bytesOf(kTarget) + bytesOf(bankDegrees) + bytesOf(kLensMm)));
    const std::string editor = material("grey", glm::vec3(0.5f)) + material("red", {0.8f, 0.1f, 0.1f}) +
                               material("blue", {0.1f, 0.1f, 0.8f}) + object("floor", floorMesh()) +
                               object("box", boxMesh()) + object("pyramid", pyramidMesh()) + light + camera;
    return chunk(0x4D4D, chunk(0x0002, bytesOf(std::uint32_t(3))) + chunk(0x3D3D, editor));
}

class Thesis3ds : public testing::Test {
protected:
    static constexpr int kSize = 96;

    void render(float bankDegrees) {
        std::ofstream(folder_.file("scene.3ds"), std::ios::binary) << sceneFile(bankDegrees);
        const std::string mesh = folder_.file("s.rtmesh"), atlas = folder_.file("s.rtatlas"),
                          exr = folder_.file("s.exr"), size = std::to_string(kSize);
        const test::CommandResult import = run({"rt-import", folder_.file("scene.3ds"), "-o", mesh});
        ASSERT_THAT(import.err, HasSubstr("20 triangles"));
        ASSERT_EQ(run({"rt-grid", mesh, "-o", atlas, "-q"}).exitCode, 0);
        const test::CommandResult trace =
            run({"rt-trace", atlas, "-o", exr, "--camera", "view", "--size", size + "x" + size, "--device",
                 "software", "--background", "0,0,0", "--reproducible"});
        ASSERT_EQ(trace.exitCode, 0) << trace.err;
        picture_ = readExr(exr);
    }

    static test::CommandResult run(std::vector<std::string> command) {
        command[0] = RT_BIN_DIR "/" + command[0];
        return test::runCommand(command);
    }

    // Colour at the pixel where the author's camera sees the point.
    glm::vec3 colorAt(const glm::dvec3& point, double rollDegrees = 0.0) const {
        const glm::dvec3 forward = glm::normalize(glm::dvec3(kTarget - kEye));
        const glm::dvec3 right0 = glm::normalize(glm::cross(forward, glm::dvec3(0, 0, 1)));
        const glm::dvec3 up0 = glm::cross(right0, forward);
        const double roll = glm::radians(rollDegrees);
        const glm::dvec3 up = up0 * std::cos(roll) + glm::cross(forward, up0) * std::sin(roll);
        const glm::dvec3 right = glm::cross(forward, up), toPoint = point - glm::dvec3(kEye);
        const double halfWidth = 18.0 / kLensMm * glm::dot(toPoint, forward);
        const double x = (glm::dot(toPoint, right) / halfWidth + 1.0) / 2.0 * kSize;
        const double y = (1.0 - glm::dot(toPoint, up) / halfWidth) / 2.0 * kSize;
        const std::size_t pixel = static_cast<std::size_t>(y) * kSize + static_cast<std::size_t>(x);
        const auto value = [&](const std::string& name) {
            const auto found = std::ranges::find(picture_.channels, name, &ImageChannel::name);
            return found->values[pixel];
        };
        return {value("R"), value("G"), value("B")};
    }

    test::TemporaryFolder folder_;
    Image picture_;
};

bool isRed(const glm::vec3& c) {
    return c.r > 4.0f * c.b && c.r > 0.01f;
}
bool isBlue(const glm::vec3& c) {
    return c.b > 4.0f * c.r && c.b > 0.01f;
}
bool isGrey(const glm::vec3& c) {
    return c.r > 0.01f && std::abs(c.r - c.b) < 0.01f * c.r;
}

TEST_F(Thesis3ds, RendersAsItsAuthorPlacedIt) {
    render(0.0f);
    EXPECT_TRUE(isRed(colorAt({-3, -1, 1})));
    EXPECT_TRUE(isBlue(colorAt({3, -0.6, 1})));
    EXPECT_TRUE(isGrey(colorAt({0, -3, 0})));
    // The box ends where the file says.
    EXPECT_TRUE(isRed(colorAt({-2.15, -1, 1.8}))) << "right edge of the box's front";
    EXPECT_FALSE(isRed(colorAt({-1.7, -1, 1.8})));
    EXPECT_TRUE(isRed(colorAt({-3.8, -1, 0.2})));
    EXPECT_FALSE(isRed(colorAt({-4.3, -1, 0.2})));
    EXPECT_TRUE(isBlue(colorAt({3, 0, 2.6}))) << "the pyramid's top";
    EXPECT_EQ(colorAt({3, 0, 3.4}), glm::vec3(0)) << "behind it there is nothing";
    EXPECT_EQ(colorAt({0, 0, 4.5}), glm::vec3(0));
    // Without smoothing groups the box has sharp edges: its front is of one brightness but for the lamp's
    // angle.
    EXPECT_NEAR(colorAt({-2.3, -1, 1.7}).r, colorAt({-2.3, -1, 0.3}).r, 0.25f * colorAt({-2.3, -1, 1}).r);
    // The lamp is on the right: the pyramid's right side is lit, the box throws its shadow to the left.
    EXPECT_GT(colorAt({3.6, -0.5, 1}).b, 1.5f * colorAt({2.35, -0.5, 1}).b);
    EXPECT_GT(colorAt({0, 1, 0}).g, 2.0f * colorAt({-4.8, 0.3, 0}).g);
    // A white surface at the scene's centre that faces the lamp has the lamp's colour, 1; the floor is grey.
    EXPECT_GT(colorAt({0, -3, 0}).g, 0.1f);
    EXPECT_LT(colorAt({0, -3, 0}).g, 1.0f);
}

// A roof whose halves meet at 23 degrees, less than the usual crease.
TEST_F(Thesis3ds, WithoutSmoothingGroupsFacesAreFlatUnlessACreaseIsGiven) {
    const std::string editor = material("grey", glm::vec3(0.5f)) +
                               object("roof", mesh({{-1, 0, 0}, {0, 0, 0.2f}, {0, 1, 0.2f}, {1, 0, 0}},
                                                   {{0, 1, 2}, {1, 3, 2}}, "grey"));
    std::ofstream(folder_.file("roof.3ds"), std::ios::binary) << chunk(0x4D4D, chunk(0x3D3D, editor));
    const auto verticesWith = [&](std::vector<std::string> options) {
        std::vector<std::string> command{"rt-import", folder_.file("roof.3ds"), "-o",
                                         folder_.file("r.rtmesh")};
        command.insert(command.end(), options.begin(), options.end());
        return run(command).err;
    };
    EXPECT_THAT(verticesWith({}), HasSubstr("2 triangles, 6 vertices"));
    EXPECT_THAT(verticesWith({"--crease", "45"}), HasSubstr("2 triangles, 4 vertices"));
    EXPECT_THAT(verticesWith({"--crease", "10"}), HasSubstr("2 triangles, 6 vertices"));
}

TEST_F(Thesis3ds, ABankedCameraTurnsThePicture) {
    render(30.0f);
    EXPECT_TRUE(isRed(colorAt({-3, -1, 1}, 30.0)) || isRed(colorAt({-3, -1, 1}, -30.0)));
    EXPECT_TRUE(isRed(colorAt({-2.15, -1, 1.8}, 30.0)));
    EXPECT_FALSE(isRed(colorAt({-1.7, -1, 1.8}, 30.0)));
    EXPECT_TRUE(isBlue(colorAt({3, 0, 2.6}, 30.0)));
}

} // namespace
} // namespace rt

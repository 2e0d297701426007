#include "common/binary_io.h"
#include "formats/atlas_file.h"
#include "formats/mesh_file.h"
#include "tests/support/make_mesh.h"
#include "tests/support/read_text.h"
#include "tests/support/run_command.h"
#include "tests/support/temporary_folder.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>

namespace rt::test {
namespace {

using testing::HasSubstr;

class GridCli : public testing::Test {
protected:
    void SetUp() override { writeMesh(mesh(), makeSphere(3)); }

    std::string mesh() const { return folder_.file("scene.rtmesh"); }
    std::string atlas() const { return folder_.file("scene.rtatlas"); }
    CommandResult grid(std::vector<std::string> arguments) const {
        arguments.insert(arguments.begin(), RT_BIN_DIR "/rt-grid");
        return runCommand(arguments);
    }
    // The exit code is `code`, one line of error was printed, and no file was made.
    void expectFailure(int code, const std::vector<std::string>& arguments, const std::string& says) const {
        const std::size_t filesBefore = folder_.entryCount();
        const CommandResult result = grid(arguments);
        EXPECT_EQ(result.exitCode, code) << result.err;
        EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
        EXPECT_EQ(result.err.rfind("rt-grid: error: ", 0), 0u) << result.err;
        EXPECT_THAT(result.err, HasSubstr(says));
        EXPECT_EQ(result.out, "");
        EXPECT_EQ(folder_.entryCount(), filesBefore);
    }

    TemporaryFolder folder_;
};

TEST_F(GridCli, buildsAnAtlasAndSaysWhatItBuilt) {
    const CommandResult result =
        grid({mesh(), "-o", atlas(), "--structure", "cloud", "--resolution", "20x30x40"});
    EXPECT_EQ(result.exitCode, 0) << result.err;
    EXPECT_EQ(result.out, "");
    EXPECT_THAT(result.err, HasSubstr("rt-grid: cloud 20x30x40 = 24000 voxels"));
    const AtlasFile file = readAtlas(atlas());
    EXPECT_EQ(file.atlas.grid.dims, glm::uvec4(20, 30, 40, kStructureCloud));
    EXPECT_EQ(file.atlas.info.meshHash, readMesh(mesh()).contentHash);
}

TEST_F(GridCli, nestedVoxelsAreReported) {
    const CommandResult result = grid({mesh(), "-o", atlas(), "--structure", "nested", "--density", "0.05",
                                       "--leaf-size", "5", "--json", "-"});
    EXPECT_EQ(result.exitCode, 0) << result.err;
    EXPECT_THAT(result.err, HasSubstr("rt-grid: nested 4x4x4 = 64 voxels"));
    EXPECT_THAT(result.err, HasSubstr("bytes per triangle"));
    const nlohmann::json json = nlohmann::json::parse(result.out);
    const Atlas built = readAtlas(atlas()).atlas;
    EXPECT_EQ(built.grid.dims.w, kStructureNested);
    EXPECT_EQ(json["bricks"], bricksOf(built, "atlas").size());
    EXPECT_EQ(json["brickWords"], built.bricks.size());
    EXPECT_TRUE(json["stagesMs"].contains("nest") && json["stagesMs"].contains("boxes"));
}

TEST_F(GridCli, reportsItsFiguresAsJson) {
    const CommandResult result = grid({mesh(), "-o", atlas(), "--structure", "uniform", "-q", "--json", "-"});
    EXPECT_EQ(result.exitCode, 0) << result.err;
    EXPECT_EQ(result.err, "");
    const nlohmann::json json = nlohmann::json::parse(result.out);
    const Atlas built = readAtlas(atlas()).atlas;
    EXPECT_EQ(json["structure"], "uniform");
    EXPECT_EQ(json["resolution"], nlohmann::json({built.grid.dims.x, built.grid.dims.y, built.grid.dims.z}));
    EXPECT_EQ(json["triangles"], 1280);
    EXPECT_EQ(json["occupiedVoxels"], built.info.occupiedVoxels);
    EXPECT_EQ(json["references"], built.info.references);
    EXPECT_EQ(json["fileBytes"], std::filesystem::file_size(atlas()));
    for (const char* stage : {"read", "rebase", "bin", "pack", "write"})
        EXPECT_TRUE(json["stagesMs"].contains(stage));
    EXPECT_FALSE(json["stagesMs"].contains("proximity"));
    for (const char* figure : {"buildMs", "trianglesPerSecond", "peakMemoryBytes"})
        EXPECT_GT(json[figure], 0.0);
}

TEST_F(GridCli, densityIsVoxelsPerTriangle) {
    EXPECT_EQ(grid({mesh(), "-o", atlas(), "--density", "50"}).exitCode, 0);
    EXPECT_NEAR(static_cast<double>(readAtlas(atlas()).atlas.voxelCount()) / 1280.0, 50.0, 4.0);
}

TEST_F(GridCli, bytesDoNotDependOnThreadsOrPaths) {
    const std::string other = folder_.file("other.rtatlas");
    const std::string vdb = folder_.file("a.vdb");
    const std::string otherVdb = folder_.file("b.vdb");
    EXPECT_EQ(grid({mesh(), "-o", atlas(), "-j", "1", "--resolution", "65", "--vdb", vdb}).exitCode, 0);
    EXPECT_EQ(grid({mesh(), "-o", other, "-j", "2", "--resolution", "65", "--vdb", otherVdb}).exitCode, 0);
    EXPECT_EQ(readText(atlas()), readText(other));
    EXPECT_EQ(readText(vdb), readText(otherVdb));
}

TEST_F(GridCli, vdbPrintReadsTheVoxels) {
    if (!std::filesystem::exists("/usr/bin/vdb_print")) GTEST_SKIP() << "vdb_print is not installed";
    writeMesh(mesh(), moved(makeSphere(3), 3.0f, glm::vec3(100.0f, 0.0f, 0.0f)));
    const std::string vdb = folder_.file("scene.vdb");
    ASSERT_EQ(grid({mesh(), "-o", atlas(), "--structure", "cloud", "--resolution", "20x30x40", "--vdb", vdb})
                  .exitCode,
              0);
    const Atlas built = readAtlas(atlas()).atlas;
    const CommandResult print = runCommand({"/usr/bin/vdb_print", "-l", vdb});
    ASSERT_EQ(print.exitCode, 0) << print.err;
    const std::size_t second = print.out.find("Name: distance");
    ASSERT_NE(second, std::string::npos) << print.out;
    const std::string occupancy = print.out.substr(0, second);
    const std::string distance = print.out.substr(second);
    const auto numberAfter = [](const std::string& text, const std::string& label) {
        const std::size_t at = text.find(label);
        return at == std::string::npos ? -1.0 : std::stod(text.substr(at + label.size()));
    };
    const auto occupied = static_cast<double>(built.info.occupiedVoxels);
    EXPECT_EQ(numberAfter(occupancy, "file_voxel_count:"), occupied);
    EXPECT_EQ(numberAfter(distance, "file_voxel_count:"), 24000.0 - occupied);
    EXPECT_EQ(numberAfter(distance, "Max value:"), built.info.maxDistance);
    EXPECT_THAT(occupancy, HasSubstr("Name: occupancy"));
    // The first voxel's centre, world space: half a voxel inside the sphere's bounds of 97..103, -3..3,
    // -3..3.
    const auto centre = [&](int axis) {
        return (built.grid.gridLo[axis] + 0.5 * built.grid.cellSize[axis]) / built.grid.worldOffset.w +
               built.grid.worldOffset[axis];
    };
    EXPECT_THAT(occupancy,
                HasSubstr(fmt::format("[{:.3g}, {:.3g}, {:.3g}, 1]", centre(0), centre(1), centre(2))));
    EXPECT_NEAR(centre(0), 97.0 + 0.5 * 6.0 / 20, 0.05);
    EXPECT_NEAR(centre(2), -3.0 + 0.5 * 6.0 / 40, 0.05);
}

TEST_F(GridCli, aUniformGridExportsOccupancyOnly) {
    if (!std::filesystem::exists("/usr/bin/vdb_print")) GTEST_SKIP() << "vdb_print is not installed";
    const std::string vdb = folder_.file("scene.vdb");
    ASSERT_EQ(grid({mesh(), "-o", atlas(), "--structure", "uniform", "--vdb", vdb}).exitCode, 0);
    const CommandResult print = runCommand({"/usr/bin/vdb_print", vdb});
    EXPECT_THAT(print.out, HasSubstr("occupancy"));
    EXPECT_THAT(print.out, testing::Not(HasSubstr("distance")));
}

TEST_F(GridCli, wrongUsageIs2) {
    expectFailure(2, {mesh(), "-o", atlas(), "--structure", "octree"}, "octree");
    expectFailure(2, {mesh(), "-o", atlas(), "--resolution", "0"}, "--resolution");
    expectFailure(2, {mesh(), "-o", atlas(), "--resolution", "4x4"}, "--resolution");
    expectFailure(2, {mesh(), "-o", atlas(), "--density", "-1"}, "--density");
    expectFailure(2, {mesh(), "-o", atlas(), "--density", "abc"}, "--density: abc is not a number");
    expectFailure(2, {mesh(), "-o", atlas(), "--density", "nan"}, "nan is not between");
    expectFailure(2, {mesh(), "-o", atlas(), "-j", "all"}, "--threads: all is not a number");
    for (const char* structure : {"uniform", "cloud", "octant"})
        expectFailure(2, {mesh(), "-o", atlas(), "--structure", structure, "--leaf-size", "5"},
                      "--leaf-size goes with --structure nested or auto");
    expectFailure(2, {mesh(), "-o", atlas(), "--density", "4", "--resolution", "4"}, "--density");
    expectFailure(2, {mesh(), "-o", atlas(), "--max-memory", "lots"}, "--max-memory");
    expectFailure(2, {mesh(), "-o", atlas(), "--vdb", atlas()}, "two outputs");
    expectFailure(2, {mesh(), "-o", mesh()}, "an input and an output");
    expectFailure(2, {mesh(), "-o", atlas(), "--vdb", folder_.file("./scene.rtmesh")},
                  "an input and an output");
    EXPECT_NO_THROW(readMesh(mesh()));
    expectFailure(2, {mesh(), "-o", "-", "--json", "-"}, "standard output");
    expectFailure(2, {mesh()}, "--output");
    expectFailure(2, {mesh(), "-o", ""}, "empty");
}

TEST_F(GridCli, filesThatCannotBeReadOrWrittenAre3) {
    expectFailure(3, {folder_.file("absent.rtmesh"), "-o", atlas()}, "absent.rtmesh");
    expectFailure(3, {mesh(), "-o", folder_.file("no/such/folder.rtatlas")}, "folder.rtatlas");
    expectFailure(3, {mesh(), "-o", atlas(), "--vdb", folder_.file("no/such/folder.vdb")}, "folder.vdb");
    expectFailure(3, {mesh(), "-o", folder_.file("no/such.rtatlas"), "--vdb", folder_.file("a.vdb")},
                  "such.rtatlas");
    expectFailure(3, {mesh(), "-o", atlas(), "--json", folder_.file("no/such.json")}, "such.json");
}

TEST_F(GridCli, invalidMeshesAre4) {
    const std::string whole = readText(mesh());
    const std::string broken = folder_.file("broken.rtmesh");
    for (const std::size_t length : {std::size_t(0), std::size_t(10), std::size_t(200), whole.size() - 1}) {
        writeFile(broken, whole.substr(0, length));
        expectFailure(4, {broken, "-o", atlas()}, "broken.rtmesh");
    }
    writeFile(broken, std::string_view("ply\nformat ascii 1.0\n"));
    expectFailure(4, {broken, "-o", atlas()}, "broken.rtmesh");
}

TEST_F(GridCli, requestsBeyondALimitAre5) {
    expectFailure(5, {mesh(), "-o", atlas(), "--resolution", "1000x1000x1000"}, "1000000000 voxels");
    expectFailure(5, {mesh(), "-o", atlas(), "--resolution", "1000"}, "536870912");
    expectFailure(5, {mesh(), "-o", atlas(), "--resolution", "65537"}, "65536");
    expectFailure(5, {mesh(), "-o", atlas(), "--resolution", "200", "--max-memory", "20M"}, "--max-memory");
}

TEST_F(GridCli, inputWithoutAnEndIsRefused) {
    expectFailure(4, {"/dev/zero", "-o", atlas()}, "/dev/zero: is not a .rtmesh file");
    const CommandResult piped =
        runCommand({"/bin/sh", "-c", RT_BIN_DIR "/rt-grid - -o " + atlas() + " < /dev/zero"});
    EXPECT_EQ(piped.exitCode, 4) << piped.err;
}

TEST_F(GridCli, memoryStaysWithinTheForecast) {
#ifdef __SANITIZE_ADDRESS__
    GTEST_SKIP() << "the sanitizer's own memory would count";
#endif
    writeMesh(mesh(), makeRandomTriangles(100000, 1, 0.02f));
    const std::vector<std::vector<std::string>> cases{
        {"--resolution", "200"},
        {"--resolution", "200", "--vdb", folder_.file("scene.vdb")},
        {"--resolution", "400", "--structure", "octant"}};
    for (const std::vector<std::string>& options : cases) {
        std::vector<std::string> arguments{mesh(), "-o", atlas(), "-q", "--json", "-"};
        arguments.insert(arguments.end(), options.begin(), options.end());
        const nlohmann::json json = nlohmann::json::parse(grid(arguments).out);
        const double besides = 64.0 * 1024 * 1024 + static_cast<double>(std::filesystem::file_size(mesh()));
        EXPECT_GT(json["forecastMemoryBytes"].get<double>(), 0.0);
        EXPECT_LT(json["peakMemoryBytes"].get<double>(), json["forecastMemoryBytes"].get<double>() + besides);
    }
}

TEST_F(GridCli, aFailedRunLeavesTheOldAtlas) {
    ASSERT_EQ(grid({mesh(), "-o", atlas()}).exitCode, 0);
    const std::string before = readText(atlas());
    EXPECT_EQ(grid({mesh(), "-o", atlas(), "--resolution", "1000"}).exitCode, 5);
    EXPECT_EQ(readText(atlas()), before);
}

TEST_F(GridCli, helpNamesTheExitCodesAndTheLimits) {
    const CommandResult result = grid({"--help"});
    EXPECT_EQ(result.exitCode, 0);
    EXPECT_THAT(result.out, HasSubstr("Exit codes:"));
    EXPECT_THAT(result.out, HasSubstr("65536"));
    EXPECT_THAT(result.out, HasSubstr("75 % of this "));
}

} // namespace
} // namespace rt::test

// rt-grid inspect, --dry-run, progress and interrupts through the executable.
#include "common/binary_io.h"
#include "formats/atlas_file.h"
#include "formats/mesh_file.h"
#include "tests/support/make_mesh.h"
#include "tests/support/read_text.h"
#include "tests/support/run_command.h"
#include "tests/support/temporary_folder.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>

namespace rt::test {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr const char* kGrid = RT_BIN_DIR "/rt-grid";

class GridInspectCli : public testing::Test {
protected:
    void SetUp() override { writeMesh(mesh(), makeSphere(3)); }
    std::string mesh() const { return folder_.file("scene.rtmesh"); }
    std::string atlas() const { return folder_.file("scene.rtatlas"); }
    CommandResult run(std::vector<std::string> arguments) const {
        arguments.insert(arguments.begin(), kGrid);
        return runCommand(arguments);
    }
    void buildNested() const {
        ASSERT_EQ(run({mesh(), "-o", atlas(), "--structure", "nested", "--density", "0.05"}).exitCode, 0);
    }

    TemporaryFolder folder_;
};

TEST_F(GridInspectCli, saysWhatIsInAnAtlas) {
    buildNested();
    const CommandResult text = run({"inspect", atlas()});
    EXPECT_EQ(text.exitCode, 0) << text.err;
    EXPECT_EQ(text.err, "");
    for (const char* part :
         {": nested, 4 voxels along x", "1280 triangles", "level", "references per leaf: mean",
          "any OpenGL 4.5 device", "BRIK", "3D texture 4x4x4", "from a triangle on"})
        EXPECT_THAT(text.out, HasSubstr(part));
    const nlohmann::json json = nlohmann::json::parse(run({"inspect", atlas(), "--json", "-"}).out);
    const AtlasFile file = readAtlas(atlas());
    EXPECT_EQ(json["structure"], "nested");
    EXPECT_EQ(json["fileBytes"], file.fileBytes);
    EXPECT_EQ(json["levels"][0]["voxels"], 64);
    EXPECT_EQ(json["referencesPerLeaf"]["count"], file.atlas.info.occupiedVoxels);
    EXPECT_EQ(json["sections"][3]["id"], "BRIK");
    EXPECT_EQ(json["sections"][3]["bytes"], file.atlas.bricks.size_bytes());
    EXPECT_EQ(json["devices"][0]["bufferBytes"], 1u << 27);
    EXPECT_GT(json["rays"]["from"]["steps"], 1.0);
}

TEST_F(GridInspectCli, writesSlicesOrNothing) {
    buildNested();
    const std::string slices = folder_.file("slices");
    EXPECT_EQ(run({"inspect", atlas(), "-q", "--slices", slices, "--slice-at", "0.5,0.25,0.5"}).exitCode, 0);
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(slices), {}), 9);
    EXPECT_THAT(readText(slices + "/distance_z.png"), testing::StartsWith("\x89PNG"));
    EXPECT_EQ(run({"inspect", atlas(), "--slice-at", "0.5,0.5,0.5"}).exitCode, 2);
    EXPECT_EQ(run({"inspect", atlas(), "--slices", slices, "--slice-at", "0.5,1.5,0.5"}).exitCode, 2);
    EXPECT_EQ(run({"inspect", atlas(), "--slices", atlas()}).exitCode, 3);
    EXPECT_EQ(run({"inspect", atlas(), "--slices", folder_.file("no/such/folder")}).exitCode, 3);
    EXPECT_EQ(run({"inspect", mesh()}).exitCode, 4);
    EXPECT_EQ(run({"inspect"}).exitCode, 2);
    EXPECT_EQ(run({"inspect", atlas(), "--vdb", atlas()}).exitCode, 2);
}

TEST_F(GridInspectCli, everyLevelIsAnOpenVdbGrid) {
    if (!std::filesystem::exists("/usr/bin/vdb_print")) GTEST_SKIP() << "vdb_print is not installed";
    buildNested();
    const std::string vdb = folder_.file("scene.vdb"), other = folder_.file("other.vdb");
    ASSERT_EQ(run({"inspect", atlas(), "-q", "--vdb", vdb}).exitCode, 0);
    ASSERT_EQ(run({"inspect", atlas(), "-q", "--vdb", other, "-j", "1"}).exitCode, 0);
    EXPECT_EQ(readText(vdb), readText(other));
    const std::string print = runCommand({"/usr/bin/vdb_print", "-l", vdb}).out;
    const nlohmann::json json = nlohmann::json::parse(run({"inspect", atlas(), "--json", "-"}).out);
    const auto countOf = [&](const std::string& grid) {
        const std::size_t name = print.find("Name: " + grid + "\n");
        const std::size_t count = name == std::string::npos ? name : print.find("file_voxel_count:", name);
        return count == std::string::npos ? -1.0 : std::stod(print.substr(count + 17));
    };
    ASSERT_GE(json["levels"].size(), 2u);
    for (const nlohmann::json& level : json["levels"]) {
        const std::string suffix = "_level" + level["level"].dump();
        EXPECT_EQ(countOf("occupancy" + suffix), level["leaves"]) << suffix;
        EXPECT_EQ(countOf("references" + suffix), level["leaves"]) << suffix;
        EXPECT_EQ(countOf("distance" + suffix), level["empty"]) << suffix;
    }
}

TEST_F(GridInspectCli, voxelsTooSmallForOpenVdbAreEnlarged) {
    writeMesh(mesh(), moved(makeSphere(2), 1e-7f, glm::vec3(0.0f)));
    const CommandResult result = run({mesh(), "-o", atlas(), "--vdb", folder_.file("scene.vdb")});
    EXPECT_EQ(result.exitCode, 0) << result.err;
    EXPECT_THAT(result.err, HasSubstr("times as large as the scene"));
}

TEST_F(GridInspectCli, aDryRunForecastsWhatTheBuildTakes) {
    writeMesh(mesh(), makeRandomTriangles(60000, 1, 0.02f));
    const std::size_t filesBefore = folder_.entryCount();
    const CommandResult text = run({mesh(), "--dry-run"});
    EXPECT_EQ(text.exitCode, 0) << text.err;
    EXPECT_THAT(text.out, HasSubstr("memory to build: about"));
    EXPECT_THAT(text.out, HasSubstr("VOXL"));
    EXPECT_THAT(text.out, HasSubstr("any OpenGL 4.5 device"));
    EXPECT_EQ(folder_.entryCount(), filesBefore);
    for (const char* structure : {"uniform", "cloud", "octant", "nested"}) {
        const auto figures = [&](std::vector<std::string> more) {
            more.insert(more.begin(), {mesh(), "--structure", structure, "-q", "--json", "-"});
            return nlohmann::json::parse(run(more).out);
        };
        const nlohmann::json forecast = figures({"--dry-run"}), built = figures({"-o", atlas()});
        for (const char* figure : {"voxels", "occupiedVoxels", "references", "fileBytes"})
            EXPECT_NEAR(forecast[figure].get<double>() / built[figure].get<double>(), 1.0, 0.15)
                << structure << figure;
#ifndef __SANITIZE_ADDRESS__ // whose own memory would count
        EXPECT_NEAR(forecast["memoryBytes"].get<double>() / built["peakMemoryBytes"].get<double>(), 1.0, 0.15)
            << structure;
#endif
    }
}

TEST_F(GridInspectCli, aDryRunBeyondALimitIs5AndSaysWhatToChange) {
    const CommandResult memory = run({mesh(), "--dry-run", "--resolution", "200", "--max-memory", "20M"});
    EXPECT_EQ(memory.exitCode, 5);
    EXPECT_THAT(memory.err, HasSubstr("lower --resolution or --density, or raise --max-memory"));
    EXPECT_EQ(run({mesh(), "--dry-run", "--resolution", "1000"}).exitCode, 5);
    // Only the lists are too long: the forecast is told nevertheless.
    writeMesh(mesh(), makeRandomTriangles(3000, 1, 0.9f));
    const CommandResult lists =
        run({mesh(), "--dry-run", "--structure", "uniform", "--resolution", "60", "--max-memory", "4M"});
    EXPECT_EQ(lists.exitCode, 5);
    EXPECT_THAT(lists.out, HasSubstr("memory to build: about"));
    EXPECT_THAT(lists.err, HasSubstr("raise --max-memory"));
}

// Standard input that comes late makes a stage last.
TEST_F(GridInspectCli, longStagesAreShownOnATerminalOnly) {
    if (!std::filesystem::exists("/usr/bin/script")) GTEST_SKIP() << "script is not installed";
    const std::string slow = "(sleep 1.5; cat " + mesh() + ") | " + kGrid + " - -o " + atlas();
    const auto onTerminal = [&](const std::string& environment) {
        return runCommand({"/usr/bin/env", "TERM=xterm", environment, "/usr/bin/script", "-qec",
                           "/bin/sh -c '" + slow + "'", "/dev/null"})
            .out;
    };
    EXPECT_THAT(onTerminal("NO_COLOR="), HasSubstr("read, 1 s"));
    EXPECT_THAT(onTerminal("NO_COLOR=1"), Not(HasSubstr("read, ")));
    EXPECT_THAT(runCommand({"/bin/sh", "-c", slow}).err, Not(HasSubstr("read, ")));
}

TEST_F(GridInspectCli, anInterruptLeavesNothingBehind) {
    writeMesh(mesh(), makeRandomTriangles(100000, 1, 0.02f));
    ASSERT_EQ(run({mesh(), "-o", atlas()}).exitCode, 0);
    const std::size_t filesBefore = folder_.entryCount();
    for (const char* seconds : {"0.05", "0.15", "0.3"}) {
        const std::string slices = folder_.file("slices");
        for (const std::vector<std::string>& command :
             {std::vector<std::string>{mesh(), "-o", folder_.file("b.rtatlas"), "--quality", "best", "--vdb",
                                       folder_.file("b.vdb")},
              std::vector<std::string>{"inspect", atlas(), "-q", "--slices", slices}}) {
            std::vector<std::string> arguments{"/usr/bin/timeout", "-s", "INT", seconds, kGrid};
            arguments.insert(arguments.end(), command.begin(), command.end());
            if (runCommand(arguments).exitCode == 124) {
                EXPECT_EQ(folder_.entryCount(), filesBefore) << seconds;
            }
            std::filesystem::remove_all(slices);
            for (const char* name : {"b.rtatlas", "b.vdb"}) std::filesystem::remove(folder_.file(name));
        }
    }
}

} // namespace
} // namespace rt::test

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

namespace rt::test {
namespace {

using testing::HasSubstr;

class GridVerifyCli : public testing::Test {
protected:
    void SetUp() override {
        writeMesh(mesh(), makeSphere(3));
        ASSERT_EQ(run({mesh(), "-o", atlas(), "--structure", "cloud"}).exitCode, 0);
    }
    std::string mesh() const { return folder_.file("scene.rtmesh"); }
    std::string atlas() const { return folder_.file("scene.rtatlas"); }
    CommandResult run(std::vector<std::string> arguments) const {
        arguments.insert(arguments.begin(), RT_BIN_DIR "/rt-grid");
        return runCommand(arguments);
    }
    CommandResult verify(std::vector<std::string> arguments) const {
        arguments.insert(arguments.begin(), "verify");
        return run(arguments);
    }

    TemporaryFolder folder_;
};

TEST_F(GridVerifyCli, aSoundAtlasIs0) {
    const CommandResult result = verify({atlas(), "--against", mesh()});
    EXPECT_EQ(result.exitCode, 0) << result.err;
    EXPECT_EQ(result.err, "");
    EXPECT_THAT(result.out, HasSubstr("ok    distances"));
    EXPECT_THAT(result.out, HasSubstr("ok    lists      1280 triangles need"));
    EXPECT_THAT(result.out, HasSubstr("ok    source"));
    EXPECT_EQ(std::count(result.out.begin(), result.out.end(), '\n'), 5);
    const nlohmann::json json = nlohmann::json::parse(verify({atlas(), "--json", "-"}).out);
    EXPECT_EQ(json["holds"], true);
    EXPECT_EQ(json["proofs"].size(), 4u);
    EXPECT_EQ(json["triangles"], 1280);
}

TEST_F(GridVerifyCli, aDistanceThatIsOneTooLongIs4AndNamed) {
    Atlas worse = readAtlas(atlas()).atlas;
    std::vector<std::uint32_t> voxels(worse.voxels.begin(), worse.voxels.end());
    const auto empty = std::find_if(voxels.begin(), voxels.end(), [](std::uint32_t w) { return w == 2; });
    ASSERT_NE(empty, voxels.end());
    *empty = 3;
    const std::size_t i = static_cast<std::size_t>(empty - voxels.begin()), width = worse.grid.dims.x;
    const std::size_t height = worse.grid.dims.y;
    worse.voxels = std::move(voxels);
    writeAtlas(atlas(), worse); // with hashes that match
    const CommandResult result = verify({atlas(), "--json", folder_.file("proof.json")});
    EXPECT_EQ(result.exitCode, 4);
    EXPECT_THAT(result.out, HasSubstr("FAULT distances"));
    const std::string place = "the distance 3 of empty voxel (" + std::to_string(i % width) + ", " +
                              std::to_string(i / width % height) + ", " + std::to_string(i / width / height) +
                              ") of level 0 lets rays leap over voxel (";
    EXPECT_THAT(result.out, HasSubstr(place));
    EXPECT_EQ(result.err.rfind("rt-grid: error: " + atlas() + ": 1 fault, the first: " + place, 0), 0u)
        << result.err;
    EXPECT_THAT(result.err, HasSubstr("which lists triangle "));
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1);
    const nlohmann::json json = nlohmann::json::parse(readText(folder_.file("proof.json")));
    EXPECT_EQ(json["holds"], false);
    EXPECT_EQ(json["proofs"][3]["faults"], 1);
}

TEST_F(GridVerifyCli, anotherMeshIs4) {
    writeMesh(mesh(), makeSphere(2));
    const CommandResult result = verify({atlas(), "--against", mesh()});
    EXPECT_EQ(result.exitCode, 4);
    EXPECT_THAT(result.err, HasSubstr("it was made from a mesh with hash"));
}

TEST_F(GridVerifyCli, damagedBytesAre4AndUsageIs2) {
    std::string bytes = readText(atlas());
    bytes[bytes.size() / 2] ^= 1;
    writeFile(atlas(), std::string_view(bytes));
    EXPECT_EQ(verify({atlas()}).exitCode, 4);
    EXPECT_EQ(verify({mesh()}).exitCode, 4);
    EXPECT_EQ(verify({folder_.file("absent.rtatlas")}).exitCode, 3);
    EXPECT_EQ(verify({}).exitCode, 2);
    EXPECT_EQ(verify({"-", "--against", "-"}).exitCode, 2);
    EXPECT_EQ(verify({atlas(), "--json", atlas()}).exitCode, 2);
    const CommandResult help = verify({"--help"});
    EXPECT_EQ(help.exitCode, 0);
    EXPECT_THAT(help.out, HasSubstr("--against"));
    EXPECT_THAT(run({"--help"}).out, HasSubstr("rt-grid verify"));
}

} // namespace
} // namespace rt::test

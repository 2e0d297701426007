// pipelines/gallery, of scenes whose models are made here.
#include "tests/support/run_command.h"
#include "tests/support/temporary_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>

namespace rt::test {
namespace {

using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;

class Gallery : public testing::Test {
protected:
    CommandResult configure(const std::string& option = "-DRT_GALLERY_SIZE=16x9") {
        return runCommand({CMAKE_PATH, "-G", "Ninja", "-S", RT_SOURCE_DIR "/pipelines/gallery", "-B", work_,
                           "-DRT_TOOLS_DIR=" RT_BIN_DIR, "-DRT_SCENES_DIR=" + folder_.file("scenes"),
                           "-DRT_GALLERY_SAMPLES=2", "-DRT_DEVICES=software", option});
    }

    // Puts something in the place of all that the scenes read; what rt-import or rt-trace read here is valid.
    void makeStandIns() {
        const std::string skipped = configure().err;
        const std::regex file(folder_.file("scenes") + "/[^ \n]+");
        for (std::sregex_iterator at(skipped.begin(), skipped.end(), file); at != std::sregex_iterator();
             ++at) {
            const std::filesystem::path path = at->str();
            std::filesystem::create_directories(path.parent_path());
            std::ofstream stream(path);
            if (path.extension() == ".hdr")
                stream << "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n" << std::string(8, '\x80');
            if (path.filename() == "bun_zipper.ply")
                stream << "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                          "property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
                          "end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
        }
    }

    TemporaryFolder folder_;
    const std::string work_ = folder_.file("build");
};

TEST_F(Gallery, RendersTheScenesWhoseModelsAreThere) {
    std::filesystem::create_directories(folder_.file("scenes/models/interior"));
    std::ofstream(folder_.file("scenes/models/interior/sponza_dabrovic.obj"))
        << "v 0 -9 -9\nv 0 9 -9\nv 0 9 9\nv 0 -9 9\nf 1 2 3 4\n";
    const CommandResult configured = configure();
    ASSERT_EQ(configured.exitCode, 0) << configured.err;
    EXPECT_THAT(configured.err, HasSubstr("statues: skipped, "));
    EXPECT_THAT(configured.err, Not(HasSubstr("sponza")));
    const CommandResult built = runCommand({CMAKE_PATH, "--build", work_});
    ASSERT_EQ(built.exitCode, 0) << built.out << built.err;
    const CommandResult table =
        runCommand({PYTHON_PATH, "-B", RT_SOURCE_DIR "/pipelines/gallery/print_table.py", work_});
    EXPECT_EQ(table.exitCode, 0) << table.err;
    EXPECT_THAT(table.out, ContainsRegex("^sponza +2 triangles +[0-9.]+ ms a sample +[0-9.]+ rays a sample"));
}

// Of the options of all scenes: each is rendered in 8x8 pixels with the atlas of the bunnies in the place of
// its own.
TEST_F(Gallery, RtTraceTakesTheOptionsOfAllScenes) {
    makeStandIns();
    const CommandResult configured = configure("-DRT_GALLERY_SIZE=8x8");
    ASSERT_EQ(configured.exitCode, 0) << configured.err;
    EXPECT_EQ(configured.err, "") << "no scene is skipped";
    const CommandResult bunnies = runCommand({CMAKE_PATH, "--build", work_, "--target", "bunnies"});
    ASSERT_EQ(bunnies.exitCode, 0) << bunnies.out << bunnies.err;
    std::istringstream steps(runCommand({CMAKE_PATH, "--build", work_, "--", "-t", "commands", "all"}).out);
    int scenes = 0;
    for (std::string step; std::getline(steps, step);) {
        const std::size_t call = step.find("/rt-trace ");
        if (call == std::string::npos) continue;
        ++scenes;
        const std::size_t start = step.find(' ', call) + 1;
        const std::string atlas = step.substr(start, step.find(' ', start) - start);
        if (!std::filesystem::exists(atlas))
            std::filesystem::copy_file(work_ + "/bunnies-atlas.rtatlas", atlas);
        const CommandResult result = runCommand({"/bin/sh", "-c", step});
        EXPECT_EQ(result.exitCode, 0) << atlas << "\n" << result.err;
    }
    EXPECT_EQ(scenes, 9);
}

TEST_F(Gallery, WhereTheModelsAreIsToldByTheEnvironmentToo) {
    const auto configureIn = [&](const std::string& environment) {
        return runCommand({"/usr/bin/env", environment, CMAKE_PATH, "-G", "Ninja", "-S",
                           RT_SOURCE_DIR "/pipelines/gallery", "-B", work_, "-DRT_TOOLS_DIR=" RT_BIN_DIR,
                           "-DRT_DEVICES=software", "-DRT_GALLERY_SCENES=sponza"})
            .err;
    };
    EXPECT_THAT(configureIn("RT_SCENES_DIR="),
                HasSubstr("sponza: skipped, without models and images: set RT_SCENES_DIR"));
    EXPECT_THAT(configureIn("RT_SCENES_DIR=/nowhere"),
                HasSubstr("sponza: skipped, without /nowhere/models/"));
}

TEST_F(Gallery, AnUnknownSceneIsRefused) {
    const CommandResult configured = configure("-DRT_GALLERY_SCENES=balloon;baloon");
    EXPECT_NE(configured.exitCode, 0);
    EXPECT_THAT(configured.err, HasSubstr("no such scene: baloon"));
}

} // namespace
} // namespace rt::test

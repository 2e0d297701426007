// pipelines/gallery, of a scene whose model is made here.
#include "tests/support/run_command.h"
#include "tests/support/temporary_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

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

TEST_F(Gallery, AnUnknownSceneIsRefused) {
    const CommandResult configured = configure("-DRT_GALLERY_SCENES=balloon;baloon");
    EXPECT_NE(configured.exitCode, 0);
    EXPECT_THAT(configured.err, HasSubstr("no such scene: baloon"));
}

} // namespace
} // namespace rt::test

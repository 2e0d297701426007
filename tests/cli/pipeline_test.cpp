#include "tests/support/run_command.h"
#include "tests/support/temporary_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <thread>

namespace rt::test {
namespace {

using testing::HasSubstr;
using testing::Not;

// A pipeline of one tetrahedron, two structures, two renders and a comparison, in a folder of its own.
class Pipeline : public testing::Test {
protected:
    Pipeline() {
        write("model.obj", "mtllib model.mtl\nusemtl red\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
                           "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
        write("model.mtl", "newmtl red\nKd 0.8 0.1 0.1\n");
        writePipeline("1e-3", "");
    }

    void write(const char* name, const std::string& text) { std::ofstream(folder_.file(name)) << text; }

    void writePipeline(const std::string& maxRmse, const std::string& cloudArguments) {
        write("CMakeLists.txt", "cmake_minimum_required(VERSION 3.25)\nproject(test LANGUAGES NONE)\n"
                                "include(" RT_SOURCE_DIR "/pipelines/RtPipeline.cmake)\n"
                                "rt_add_scene(scene MODEL model.obj)\n"
                                "rt_add_atlas(uniform SCENE scene STRUCTURE uniform RESOLUTION 8)\n"
                                "rt_add_atlas(cloud SCENE scene STRUCTURE cloud)\n"
                                "rt_add_render(a ATLAS uniform SIZE 16x8 ARGS --device software)\n"
                                "rt_add_render(b ATLAS cloud SIZE 16x8 ARGS --device software " +
                                    cloudArguments +
                                    ")\n"
                                    "rt_add_comparison(comparison A a B b MAX_RMSE " +
                                    maxRmse + ")\n");
    }

    CommandResult configure() {
        return runCommand({CMAKE_PATH, "-G", "Ninja", "-S", folder_.file("."), "-B", folder_.file("build"),
                           "-DRT_TOOLS_DIR=" RT_BIN_DIR});
    }

    CommandResult build() { return runCommand({CMAKE_PATH, "--build", folder_.file("build"), "--", "-v"}); }

    void expectNothingToDo() { EXPECT_THAT(build().out, HasSubstr("no work to do")); }

    // Newer than any output; the pause is longer than the ticks of a file system's clock.
    void touch(const char* name) {
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
        std::filesystem::last_write_time(folder_.file(name), std::filesystem::file_time_type::clock::now());
    }

    nlohmann::json report(const char* name) {
        std::ifstream file(folder_.file("build") + "/" + name + ".json");
        return nlohmann::json::parse(file);
    }

    TemporaryFolder folder_;
};

TEST_F(Pipeline, RunsOnceAndThenHasNothingToDo) {
    ASSERT_EQ(configure().exitCode, 0);
    const CommandResult first = build();
    ASSERT_EQ(first.exitCode, 0) << first.out << first.err;
    EXPECT_EQ(report("scene").at("triangles"), 4);
    EXPECT_EQ(report("comparison").at("verdict"), "pass");
    for (const char* file : {"a.exr", "a.png", "b.exr", "b.png"})
        EXPECT_TRUE(std::filesystem::exists(folder_.file("build") + "/" + file)) << file;
    expectNothingToDo();
}

TEST_F(Pipeline, ATouchedModelIsImportedAgainAndNothingElseRuns) {
    ASSERT_EQ(configure().exitCode, 0);
    ASSERT_EQ(build().exitCode, 0);
    for (const char* file : {"model.obj", "model.mtl"}) { // the second is known from the depfile only
        touch(file);
        const CommandResult result = build();
        EXPECT_THAT(result.out, HasSubstr("rt-import"));
        EXPECT_THAT(result.out, Not(HasSubstr("rt-grid")));
        expectNothingToDo();
    }
}

TEST_F(Pipeline, AChangedMaterialReachesThePictures) {
    ASSERT_EQ(configure().exitCode, 0);
    ASSERT_EQ(build().exitCode, 0);
    write("model.mtl", "newmtl red\nKd 0.1 0.8 0.1\n");
    touch("model.mtl");
    EXPECT_THAT(build().out, HasSubstr("rt-compare"));
    expectNothingToDo();
}

TEST_F(Pipeline, AFailingComparisonFailsEveryRunUntilItPasses) {
    writePipeline("1e-3", "--background 0.5");
    ASSERT_EQ(configure().exitCode, 0);
    for (int run = 0; run < 2; ++run) {
        const CommandResult result = build();
        EXPECT_NE(result.exitCode, 0);
        EXPECT_THAT(result.out, HasSubstr("verdict: fail"));
    }
    writePipeline("10", "--background 0.5");
    EXPECT_EQ(build().exitCode, 0);
}

TEST_F(Pipeline, AWrongCallIsRefusedWhenItIsConfigured) {
    write("CMakeLists.txt", "cmake_minimum_required(VERSION 3.25)\nproject(test LANGUAGES NONE)\n"
                            "include(" RT_SOURCE_DIR "/pipelines/RtPipeline.cmake)\n"
                            "rt_add_atlas(uniform STRUCTURE uniform)\n");
    const CommandResult result = configure();
    EXPECT_NE(result.exitCode, 0);
    EXPECT_THAT(result.err, HasSubstr("SCENE is missing"));
}

} // namespace
} // namespace rt::test

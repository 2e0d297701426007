#include "tests/support/read_text.h"
#include "tests/support/run_command.h"
#include "tests/support/temporary_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <regex>
#include <thread>

namespace rt::test {
namespace {

using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;

// A pipeline of one tetrahedron, two structures, two renders and a comparison, in a folder of its own.
class Pipeline : public testing::Test {
protected:
    Pipeline() {
        write("model.obj", "mtllib model.mtl\nusemtl red\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
                           "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
        write("model.mtl", "newmtl red\nKd 0.8 0.1 0.1\n");
    }

    void write(const char* name, const std::string& text) { std::ofstream(folder_.file(name)) << text; }

    // Newer than any output; the pause is longer than the ticks of a file system's clock.
    void touch(const char* name) {
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
        std::filesystem::last_write_time(folder_.file(name), std::filesystem::file_time_type::clock::now());
    }

    TemporaryFolder folder_;
};

class CMakePipeline : public Pipeline {
protected:
    CMakePipeline() { writePipeline("1e-3", ""); }

    void writePipeline(const std::string& maxRmse, const std::string& cloudArguments) {
        writeSteps("rt_add_atlas(uniform SCENE scene STRUCTURE uniform RESOLUTION 8)\n"
                   "rt_add_atlas(cloud SCENE scene STRUCTURE cloud)\n"
                   "rt_add_render(a ATLAS uniform SIZE 16x8)\n"
                   "rt_add_render(b ATLAS cloud SIZE 16x8 PASSES Z albedo ARGS " +
                   cloudArguments + ")\nrt_add_comparison(comparison A a B b MAX_RMSE " + maxRmse +
                   " ARGS --channels R,G,B,Z)\n");
    }

    void writeSteps(const std::string& steps) {
        write("CMakeLists.txt", "cmake_minimum_required(VERSION 3.25)\nproject(test LANGUAGES NONE)\n"
                                "include(" RT_SOURCE_DIR "/pipelines/RtPipeline.cmake)\n"
                                "set(models mine)\nset(files mine)\nset(of_render mine)\n"
                                "rt_add_scene(scene MODELS model.obj)\n" +
                                    steps);
    }

    CommandResult configure(const std::string& devices = "software", const std::string& tools = RT_BIN_DIR) {
        return runCommand({CMAKE_PATH, "-G", "Ninja", "-S", folder_.file("."), "-B", folder_.file("build"),
                           "-DRT_TOOLS_DIR=" + tools, "-DRT_DEVICES=" + devices});
    }

    CommandResult build(const std::string& target = "all") {
        return runCommand({CMAKE_PATH, "--build", folder_.file("build"), "--target", target, "--", "-v"});
    }
    CommandResult test() {
        return runCommand({CTEST_PATH, "--test-dir", folder_.file("build"), "--output-on-failure"});
    }

    void expectNothingToDo() { EXPECT_THAT(build().out, HasSubstr("no work to do")); }

    nlohmann::json report(const char* name) {
        std::ifstream file(folder_.file("build") + "/" + name + ".json");
        return nlohmann::json::parse(file);
    }
};

TEST_F(CMakePipeline, RunsOnceAndThenHasNothingToDo) {
    ASSERT_EQ(configure().exitCode, 0);
    const CommandResult first = build();
    ASSERT_EQ(first.exitCode, 0) << first.out << first.err;
    EXPECT_EQ(report("scene").at("triangles"), 4);
    for (const char* file : {"a.exr", "a.png", "b.exr", "b.png"})
        EXPECT_TRUE(std::filesystem::exists(folder_.file("build") + "/" + file)) << file;
    const CommandResult tested = test();
    EXPECT_EQ(tested.exitCode, 0) << tested.out;
    EXPECT_EQ(report("comparison").at("verdict"), "pass");
    EXPECT_TRUE(std::filesystem::exists(folder_.file("build/comparison.html")));
    expectNothingToDo();
}

TEST_F(CMakePipeline, ATouchedModelIsLookedAtAndNothingElseRuns) {
    ASSERT_EQ(configure().exitCode, 0);
    ASSERT_EQ(build().exitCode, 0);
    for (const char* file : {"model.obj", "model.mtl"}) { // the second is known from the depfile only
        touch(file);
        const CommandResult result = build();
        EXPECT_THAT(result.out, HasSubstr("up to date"));
        EXPECT_THAT(result.out, Not(HasSubstr("rt-grid")));
        expectNothingToDo();
    }
}

TEST_F(CMakePipeline, AChangedMaterialReachesThePictures) {
    ASSERT_EQ(configure().exitCode, 0);
    ASSERT_EQ(build().exitCode, 0);
    write("model.mtl", "newmtl red\nKd 0.1 0.8 0.1\n");
    touch("model.mtl");
    EXPECT_THAT(build().out, HasSubstr("rt-trace"));
    expectNothingToDo();
}

TEST_F(CMakePipeline, AFailingComparisonFailsEveryRunUntilItPasses) {
    writePipeline("1e-3", "--background 0.5");
    ASSERT_EQ(configure().exitCode, 0);
    ASSERT_EQ(build().exitCode, 0);
    for (int run = 0; run < 2; ++run) {
        const CommandResult result = test();
        EXPECT_NE(result.exitCode, 0);
        EXPECT_THAT(result.out, HasSubstr("verdict: fail"));
    }
    writePipeline("10", "--background 0.5");
    ASSERT_EQ(build().exitCode, 0);
    EXPECT_EQ(test().exitCode, 0);
}

TEST_F(CMakePipeline, WrongCallsAreRefusedWhenTheyAreConfigured) {
    const auto expectRefused = [&](const char* call, const char* words) {
        writeSteps(call);
        const CommandResult result = configure();
        EXPECT_NE(result.exitCode, 0);
        // CMake breaks lines.
        EXPECT_THAT(std::regex_replace(result.err, std::regex("\\s+"), " "), HasSubstr(words));
    };
    expectRefused("rt_add_atlas(uniform STRUCTURE uniform)\n", "SCENE is missing");
    expectRefused("rt_add_atlas(x SCENE scenes)\n", "x needs scenes.rtmesh, which nothing makes in ");
    expectRefused(
        "rt_add_render(r ATLAS scene SIZE 8x8)\nrt_add_atlas(x SCENE scene)\nrt_add_atlas(y SCENE scene)\n",
        "r needs scene.rtatlas, which nothing makes");
    expectRefused(
        "rt_add_query(q ATLAS z RAYS few.rays)\nrt_add_atlas(x SCENE scene)\nrt_add_atlas(y SCENE scene)\n",
        "/build; known there: x.rtatlas, y.rtatlas");
    expectRefused("rt_add_atlas(x SCENE scene)\nrt_add_render(r ATLAS x SIZE 8x8 FRAMES many)\n",
                  "not a range");
    expectRefused("rt_add_atlas(x SCENE scene)\nrt_add_render(r ATLAS x SIZE 8x8 FRAMES 3-1)\n",
                  "FRAMES 3-1: the last frame is before the first");
    expectRefused("rt_add_atlas(x SCENE scene)\nrt_add_render(r ATLAS x SIZE 8x8)\nrt_add_regression(g "
                  "RENDER r GOLDENS g)\n"
                  "rt_add_render(s ATLAS update_g SIZE 8x8)\n",
                  "s needs update_g.rtatlas, which nothing makes");
    expectRefused("rt_add_query(q ATLAS x)\n", "RAYS is missing");
    expectRefused("rt_add_atlas(x SCENE scene)\nrt_add_render(r ATLAS x SIZE 8x8)\n"
                  "rt_add_comparison(c A r B scene)\n",
                  "scene is no rt_add_render() above this call; there are: r");
    expectRefused("rt_add_atlas(x SCENE scene)\nrt_add_render(r ATLAS x SIZE 8x8)\n"
                  "rt_add_regression(r RENDER r GOLDENS g)\n",
                  "r is a step already");
    expectRefused("rt_add_atlas(x SCENE scene)\nrt_add_render(r ATLAS x SIZE 8x8)\n"
                  "rt_add_regression(c RENDER r GOLDENS build)\n",
                  "would be compared with itself");
    expectRefused("rt_add_atlas(x SCENE scene)\nrt_add_render(r ATLAS x SIZE 8x8)\n"
                  "rt_add_regression(s RENDER r GOLDENS g)\nrt_add_render(s ATLAS x SIZE 8x8)\n",
                  "s is a comparison already");
}

TEST_F(CMakePipeline, WhatStepsNameMayBeMadeLaterOrByHandOrBeThere) {
    std::filesystem::create_directories(folder_.file("sub"));
    std::filesystem::create_directories(folder_.file("build/sub"));
    write("sub/CMakeLists.txt",
          "rt_add_render(picture ATLAS late SIZE 8x8)\nrt_add_atlas(late SCENE hand)\n"
          "add_custom_command(OUTPUT hand.rtmesh COMMAND ${CMAKE_COMMAND} -E copy "
          "${CMAKE_BINARY_DIR}/scene.rtmesh "
          "hand.rtmesh DEPENDS scene)\nadd_custom_target(own COMMAND true)\nrt_add_atlas(x SCENE own)\n"
          "rt_add_atlas(y SCENE there)\nrt_add_atlas(z SCENE there)\n");
    write("build/sub/there.rtmesh", "");
    writeSteps("add_subdirectory(sub)\n");
    const CommandResult configured = configure();
    ASSERT_EQ(configured.exitCode, 0) << configured.err;
    EXPECT_EQ(configured.err,
              folder_.file("build") + "/sub/there.rtmesh is taken as it is, since nothing makes it\n");
    const CommandResult built = build("picture");
    EXPECT_EQ(built.exitCode, 0) << built.out << built.err;
}

TEST_F(CMakePipeline, AnAtlasThatAnEarlierCallMadeIsNotTakenForOneThatIsThere) {
    writeSteps("rt_add_atlas(x SCENE scene)\nrt_add_render(r ATLAS x SIZE 8x8)\n");
    ASSERT_EQ(configure().exitCode, 0);
    ASSERT_EQ(build().exitCode, 0);
    writeSteps("rt_add_atlas(renamed SCENE scene)\nrt_add_render(r ATLAS x SIZE 8x8)\n");
    const CommandResult refused = configure();
    EXPECT_NE(refused.exitCode, 0);
    EXPECT_THAT(refused.err, HasSubstr("x.rtatlas, whose step is gone"));
}

TEST_F(CMakePipeline, ATextureThatWasMissingIsSeenWhenItAppears) {
    write("model.obj", "mtllib model.mtl\nusemtl red\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n");
    write("model.mtl", "newmtl red\nmap_Kd art/red.ppm\n");
    writeSteps("rt_add_atlas(atlas SCENE scene)\n");
    ASSERT_EQ(configure().exitCode, 0);
    ASSERT_EQ(build().exitCode, 0);
    expectNothingToDo();
    std::filesystem::create_directory(folder_.file("art"));
    EXPECT_THAT(build().out, HasSubstr("up to date"));
    expectNothingToDo();
    write("art/red.ppm", "P6 1 1 255\nabc");
    EXPECT_THAT(build().out, HasSubstr("rt-grid"));
    EXPECT_EQ(report("scene").at("images"), 1);
    expectNothingToDo();
}

TEST_F(CMakePipeline, ValuesThatReadAsFalseReachTheTools) {
    writeSteps("rt_add_atlas(x SCENE scene RESOLUTION 0)\n"
               "rt_add_render(r ATLAS x SIZE 8x8 SAMPLES 0 CAMERA no PASSES N)\n"
               "rt_add_render(other ATLAS x SIZE 8x8)\nrt_add_comparison(c A r B other MAX_RMSE 0)\n");
    ASSERT_EQ(configure().exitCode, 0);
    const std::string steps = readText(folder_.file("build/build.ninja"));
    for (const char* option : {" --resolution 0 ", " --spp 0 ", " --camera no ", " --aov N "})
        EXPECT_THAT(steps, HasSubstr(option));
    EXPECT_THAT(readText(folder_.file("build/CTestTestfile.cmake")), HasSubstr("\"--max-rmse\" \"0\""));
}

TEST_F(CMakePipeline, TwoFoldersOfAProjectMayHavePipelinesThatIncludeIt) {
    for (const char* name : {"one", "two", "without"}) {
        std::filesystem::create_directory(folder_.file(name));
        const bool includes = name != std::string("without");
        std::filesystem::create_directory(folder_.file(name + std::string("/deeper")));
        write((name + std::string("/CMakeLists.txt")).c_str(), "add_subdirectory(deeper)\n");
        write((name + std::string("/deeper/CMakeLists.txt")).c_str(),
              std::string(includes ? "include(" RT_SOURCE_DIR "/pipelines/RtPipeline.cmake)\n" : "") +
                  "rt_add_scene(" + name + " MODELS ../../model.obj)\n");
    }
    std::ofstream(folder_.file("two/deeper/CMakeLists.txt"), std::ios::app)
        << "rt_add_atlas(atlas SCENE two)\nrt_add_render(r ATLAS atlas SIZE 8x8)\n"
           "rt_add_regression(gate RENDER r GOLDENS none)\n";
    const std::string project = "cmake_minimum_required(VERSION 3.25)\nproject(test LANGUAGES NONE)\n"
                                "add_subdirectory(one)\nadd_subdirectory(two)\n";
    write("CMakeLists.txt", project);
    ASSERT_EQ(configure().exitCode, 0);
    const CommandResult built = build();
    EXPECT_EQ(built.exitCode, 0) << built.out << built.err;
    EXPECT_TRUE(std::filesystem::exists(folder_.file("build/two/deeper/two.rtmesh")));
    const CommandResult tested = test(); // from the top: tests below it are found, and have no goldens
    EXPECT_NE(tested.exitCode, 0);
    EXPECT_THAT(tested.out, HasSubstr("gate"));
    write("CMakeLists.txt", project + "add_subdirectory(without)\n");
    const CommandResult refused = configure();
    EXPECT_NE(refused.exitCode, 0);
    EXPECT_THAT(refused.err, HasSubstr("RtPipeline.cmake is included neither in this folder"));
}

TEST_F(CMakePipeline, MissingToolsAreNamedAndFoundWhereTheyAreNext) {
    const CommandResult result = configure("software", folder_.file("nowhere"));
    EXPECT_NE(result.exitCode, 0);
    EXPECT_THAT(result.err, HasSubstr("rt-import is not in PATH or RT_TOOLS_DIR"));
    EXPECT_THAT(result.err, HasSubstr("-D RT_TOOLS_DIR="));
    EXPECT_EQ(configure().exitCode, 0);
}

TEST_F(CMakePipeline, MakefilesMakeEachStepOnceAndOneAtATimeOnADevice) {
    writeSteps("foreach(i RANGE 1 3)\nrt_add_render(a${i} ATLAS atlas${i} SIZE 8x8)\n"
               "rt_add_atlas(atlas${i} SCENE scene)\nrt_add_render(b${i} ATLAS atlas${i} SIZE 8x8)\n"
               "endforeach()\nrt_add_regression(test RENDER a1 GOLDENS goldens)\n");
    // An rt-trace that fails where another one is at work.
    const std::string trace = folder_.file("rt-trace"), busy = folder_.file("busy");
    write("rt-trace", "#!/bin/sh\nmkdir " + busy +
                          " || exit\nsleep 0.05\n" RT_BIN_DIR "/rt-trace \"$@\" && rmdir " + busy + "\n");
    std::filesystem::permissions(trace, std::filesystem::perms::owner_all);
    ASSERT_EQ(
        runCommand({CMAKE_PATH, "-G", "Unix Makefiles", "-S", folder_.file("."), "-B", folder_.file("build"),
                    "-DRT_TOOLS_DIR=" RT_BIN_DIR, "-DRT_DEVICES=software", "-DRT_TRACE=" + trace})
            .exitCode,
        0);
    const CommandResult built = runCommand(
        {CMAKE_PATH, "--build", folder_.file("build"), "-j8", "--target", "all", "update_goldens"});
    ASSERT_EQ(built.exitCode, 0) << built.err;
    for (const std::string step : {"scene", "atlas1", "atlas2", "atlas3", "a1", "b3"}) {
        const std::string line = "Making " + step + "\n";
        const std::size_t first = built.out.find(line);
        EXPECT_NE(first, std::string::npos) << step;
        EXPECT_EQ(built.out.find(line, first + 1), std::string::npos) << step << " is made twice";
    }
}

TEST_F(CMakePipeline, FramesAreSharedByDevicesAndHeldAgainstGoldens) {
    writeSteps("rt_add_atlas(atlas SCENE scene)\n"
               "rt_add_render(turn ATLAS atlas SIZE 16x8 FRAMES 9-11 ARGS --turntable 12)\n"
               "rt_add_regression(turn_test RENDER turn GOLDENS goldens MAX_RMSE 1e-3)\n");
    ASSERT_EQ(configure("software,auto").exitCode, 0);
    const CommandResult built = build();
    ASSERT_EQ(built.exitCode, 0) << built.out << built.err;
    EXPECT_THAT(built.out, HasSubstr("--device software"));
    EXPECT_THAT(built.out, Not(HasSubstr("--device auto"))) << "RT_DEVICE may say which";
    EXPECT_NE(test().exitCode, 0) << "there are no goldens";
    EXPECT_EQ(build("update_goldens").exitCode, 0);
    for (const char* frame : {"turn.0009.exr", "turn.0010.exr", "turn.0011.exr"})
        EXPECT_TRUE(std::filesystem::exists(folder_.file("goldens/") + frame)) << frame;
    EXPECT_EQ(test().exitCode, 0);
    write("model.mtl", "newmtl red\nKd 0.1 0.8 0.1\n");
    touch("model.mtl");
    ASSERT_EQ(build().exitCode, 0);
    EXPECT_NE(test().exitCode, 0) << "the goldens are of the old colour";
}

TEST_F(CMakePipeline, AQueryFindsTheHitsOfItsRays) {
    const auto ray = [](float x, float towardsZ) {
        const float values[] = {x, 0.1f, -1.0f, 0.0f, 0.0f, 0.0f, towardsZ, 1e30f};
        return std::string(reinterpret_cast<const char*>(values), sizeof values);
    };
    write("few.rays", ray(0.1f, 1.0f) + ray(0.1f, -1.0f));
    writeSteps(
        "rt_add_atlas(atlas SCENE scene)\nrt_add_query(query ATLAS atlas RAYS few.rays ARGS --any-hit)\n");
    ASSERT_EQ(configure().exitCode, 0);
    const CommandResult built = build();
    ASSERT_EQ(built.exitCode, 0) << built.out << built.err;
    EXPECT_EQ(std::filesystem::file_size(folder_.file("build/query.hits")), 2u * 16u);
    EXPECT_EQ(report("query").at("hits"), 1);
    EXPECT_EQ(report("query").at("anyHit"), true);
    expectNothingToDo();
    touch("few.rays");
    EXPECT_THAT(build().out, HasSubstr("up to date"));
    write("few.rays", ray(0.1f, 1.0f) + ray(0.2f, 1.0f) + ray(0.1f, -1.0f));
    touch("few.rays");
    EXPECT_EQ(build().exitCode, 0);
    EXPECT_EQ(report("query").at("hits"), 2);
}

class MakePipeline : public Pipeline {
protected:
    MakePipeline() {
        std::filesystem::create_directory(folder_.file("goldens"));
        write("Makefile", "RT_TOOLS_DIR = " RT_BIN_DIR "\nRT_DEVICES = software,software\n"
                          "FRAMES = turn.0008 turn.0009\n"
                          "test: $(FRAMES:%=%.passed)\n"
                          "include " RT_SOURCE_DIR "/pipelines/rt.mk\n"
                          "coarse.rtatlas: model.rtmesh\n"
                          "coarse.rtatlas: RT_GRID_FLAGS = --structure cloud --resolution 8\n"
                          "$(FRAMES:%=%.exr): coarse.rtatlas\n"
                          "RT_TRACE_FLAGS = --size 16x8 --turntable 12\n"
                          "$(FRAMES:%=%.passed): %.passed: %.exr goldens/%.exr\n"
                          "down.hits: coarse.rtatlas down.rays\nRT_QUERY_FLAGS = --any-hit\n"
                          "update-goldens: $(FRAMES:%=%.exr)\n\tcp $^ goldens/\n");
    }

    CommandResult makeWith(const char* flags, const char* target = "turn.0008.exr") {
        return runCommand({"/usr/bin/make", "-C", folder_.file("."), target, flags});
    }
    CommandResult make(const char* target) {
        return runCommand({"/usr/bin/make", "-k", "-j2", "-C", folder_.file("."), target});
    }
};

TEST_F(MakePipeline, FramesAreHeldAgainstGoldens) {
    const CommandResult noGoldens = make("test");
    EXPECT_NE(noGoldens.exitCode, 0);
    EXPECT_THAT(noGoldens.err, HasSubstr("goldens/turn.0008.exr is missing"));
    EXPECT_THAT(noGoldens.err, HasSubstr("update-goldens"));
    const CommandResult updated = make("update-goldens");
    ASSERT_EQ(updated.exitCode, 0) << updated.out << updated.err;
    const CommandResult tested = make("test");
    EXPECT_EQ(tested.exitCode, 0) << tested.out << tested.err;
    EXPECT_THAT(make("test").err, Not(HasSubstr("Mrays"))); // all is looked at, nothing made
    EXPECT_TRUE(std::filesystem::exists(folder_.file("turn.0009.passed")));

    touch("model.obj");
    const CommandResult touched = make("test");
    EXPECT_EQ(touched.exitCode, 0);
    for (const char* made : {"model.rtmesh", "coarse.rtatlas", "turn.0009.exr", "turn.0009.html"})
        EXPECT_THAT(touched.err, ContainsRegex(std::string("up to date: .*") + made));

    // Options count, and content does where an older file takes the place of another.
    EXPECT_THAT(makeWith("RT_TRACE_FLAGS=--size 24x8 --turntable 12").err,
                Not(HasSubstr("up to date: turn")));
    ASSERT_EQ(make("test").exitCode, 0);
    write("model.mtl", "newmtl red\nKd 0.1 0.8 0.1\n"); // no prerequisite: rt-import knows it
    std::filesystem::last_write_time(
        folder_.file("model.mtl"), std::filesystem::file_time_type::clock::now() - std::chrono::hours(1000));
    const CommandResult changed = make("test");
    EXPECT_NE(changed.exitCode, 0);
    EXPECT_THAT(changed.out, HasSubstr("verdict: fail"));
    EXPECT_FALSE(std::filesystem::exists(folder_.file("turn.0008.passed")));
}

TEST_F(MakePipeline, NoPassedIsLeftOfARunThatDoesNotComeToComparing) {
    ASSERT_EQ(make("update-goldens").exitCode, 0);
    for (const char* flags :
         {"RT_TRACE_FLAGS=--no-such", "RT_IMPORT_FLAGS=--no-such", "RT_MODELS=none.obj"}) {
        ASSERT_EQ(make("test").exitCode, 0);
        makeWith("-n", "test");
        EXPECT_TRUE(std::filesystem::exists(folder_.file("turn.0009.passed")));
        EXPECT_NE(makeWith(flags, "test").exitCode, 0);
        for (const char* passed : {"turn.0008.passed", "turn.0009.passed"})
            EXPECT_FALSE(std::filesystem::exists(folder_.file(passed))) << passed << " with " << flags;
    }
}

TEST_F(MakePipeline, WhoeverWantsThePngGetsTheNewPicture) {
    std::ofstream(folder_.file("Makefile"), std::ios::app)
        << "both: turn.0008.png turn.0009.png test\nalone: other.png\n";
    ASSERT_EQ(make("turn.0008.png").exitCode, 0);
    ASSERT_EQ(make("update-goldens").exitCode, 0);
    for (const char* device : {"0", "1"}) // a lock for each, though they have one name
        EXPECT_TRUE(std::filesystem::exists(folder_.file(".rt-device-" + std::string(device) + ".lock")));
    ASSERT_EQ(make("both").exitCode, 0);
    write("model.mtl", "newmtl red\nKd 0.1 0.8 0.1\n");
    const CommandResult changed = make("both");
    EXPECT_NE(changed.exitCode, 0);
    EXPECT_THAT(changed.out, HasSubstr("verdict: fail"));
    std::filesystem::remove(folder_.file("turn.0009.png"));
    EXPECT_EQ(make("turn.0009.png").exitCode, 0);
    EXPECT_TRUE(std::filesystem::exists(folder_.file("turn.0009.png")));
    EXPECT_THAT(make("alone").err, HasSubstr("other.png is missing"));
    write("other.exr", "a texture");
    EXPECT_THAT(make("alone").err, HasSubstr("other.png is missing"));
    write("other.png", "a picture of somebody's own");
    EXPECT_EQ(make("alone").exitCode, 0);
}

TEST_F(MakePipeline, AQueryFindsTheHitsOfItsRays) {
    EXPECT_THAT(make("down.hits").err, HasSubstr("down.rays"));
    const float ray[] = {0.1f, 0.1f, -1.0f, 0.0f, 0.0f, 0.0f, 1.0f, 1e30f};
    write("down.rays", std::string(reinterpret_cast<const char*>(ray), sizeof ray));
    const CommandResult made = make("down.hits");
    EXPECT_EQ(made.exitCode, 0) << made.err;
    EXPECT_THAT(made.out, HasSubstr("--any-hit"));
    EXPECT_EQ(std::filesystem::file_size(folder_.file("down.hits")), 16u);
    EXPECT_THAT(make("down.hits").err, HasSubstr("up to date: down.hits"));
}

TEST_F(MakePipeline, AFrameIsThatOfADirectCall) {
    ASSERT_EQ(make("turn.0008.exr").exitCode, 0);
    const CommandResult direct = runCommand({RT_BIN_DIR "/rt-trace", folder_.file("coarse.rtatlas"), "-o",
                                             folder_.file("direct.exr"), "--frames", "8", "--turntable", "12",
                                             "--size", "16x8", "--device", "software", "--reproducible"});
    ASSERT_EQ(direct.exitCode, 0) << direct.err;
    EXPECT_EQ(
        runCommand({RT_BIN_DIR "/rt-compare", folder_.file("direct.exr"), folder_.file("turn.0008.exr")})
            .exitCode,
        0);
}

} // namespace
} // namespace rt::test

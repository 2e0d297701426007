// pipelines/benchmark in its reduced form, on scenes that need no model from elsewhere.
#include "tests/support/read_csv.h"
#include "tests/support/read_text.h"
#include "tests/support/run_command.h"
#include "tests/support/temporary_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>

namespace rt::test {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

class BenchmarkPipeline : public testing::Test {
protected:
    // A stand-in for the bunny, of which 16 copies are scattered too.
    BenchmarkPipeline() {
        const std::string model = folder_.file("scenes/models/statues/bun_zipper.ply");
        std::filesystem::create_directories(std::filesystem::path(model).parent_path());
        EXPECT_EQ(runCommand({PYTHON_PATH, "-B", RT_SOURCE_DIR "/pipelines/benchmark/make_scene.py", model,
                              "slivers", "200"})
                      .exitCode,
                  0);
    }

    CommandResult run(const std::string& tools, const std::vector<std::string>& arguments) {
        std::vector<std::string> argv = {PYTHON_PATH,
                                         "-B",
                                         RT_SOURCE_DIR "/pipelines/benchmark/run.py",
                                         "--tools",
                                         tools,
                                         "--out",
                                         out_,
                                         "--device",
                                         "software",
                                         "--reduced",
                                         "--size",
                                         "32",
                                         "--repeat",
                                         "0",
                                         "--scenes-dir",
                                         folder_.file("scenes")};
        argv.insert(argv.end(), arguments.begin(), arguments.end());
        return runCommand(argv);
    }

    // A folder of the tools with this shell script in the place of rt-trace.
    std::string toolsWithTrace(const std::string& script) {
        std::string tools = folder_.file("tools");
        std::filesystem::create_directory(tools);
        for (const char* tool : {"rt-import", "rt-grid", "rt_make_rays", "rt_check_hits"})
            std::filesystem::create_symlink(std::string(RT_BIN_DIR "/") + tool, tools + "/" + tool);
        std::ofstream(tools + "/rt-trace") << "#!/bin/sh\n" << script;
        std::filesystem::permissions(tools + "/rt-trace", std::filesystem::perms::owner_all);
        return tools;
    }

    TemporaryFolder folder_;
    const std::string out_ = folder_.file("out");
};

void expectFigures(const CsvRow& row) {
    for (const char* column : {"mrays_per_s", "embree_mrays_per_s", "ratio", "bytes_per_triangle",
                               "build_mtris_per_s", "embree_build_mtris_per_s"})
        EXPECT_GT(std::stod(row.at(column)), 0.0) << column;
    EXPECT_NEAR(std::stod(row.at("ratio")),
                std::stod(row.at("mrays_per_s")) / std::stod(row.at("embree_mrays_per_s")),
                1e-3 * std::stod(row.at("ratio")));
    for (const char* column : {"lost", "extra", "wrong"}) EXPECT_EQ(row.at(column), "0") << column;
    EXPECT_THAT(row.at("device"), HasSubstr("llvmpipe"));
    EXPECT_EQ(row.at("note"), "");
}

TEST_F(BenchmarkPipeline, MeasuresEveryStructureAndSetAndFindsEmbreesHits) {
    const CommandResult result =
        run(RT_BIN_DIR, {"--scenes", "slivers", "bunnies16", "bunny_stadium", "dragon"});
    ASSERT_EQ(result.exitCode, 0) << result.err;
    EXPECT_THAT(result.err, HasSubstr("dragon: skipped"));
    const std::map<std::string, std::string> triangles = {
        {"slivers", "2000"}, {"bunnies16", "3202"}, {"bunny_stadium", "210"}};
    std::map<std::string, std::set<std::string>> setsOf;
    for (const CsvRow& row : readCsv(out_ + "/results.csv")) {
        expectFigures(row);
        setsOf[row.at("scene") + " " + row.at("structure") + row.at("options")].insert(row.at("set"));
        EXPECT_EQ(row.at("triangles"), triangles.at(row.at("scene")));
        if (row.at("set") == "primary") {
            EXPECT_EQ(row.at("rays"), "1024");
            EXPECT_GT(std::stoi(row.at("hits")), 20);
        }
    }
    for (const char* variant :
         {"slivers uniform", "slivers cloud", "slivers octant", "slivers nested",
          "slivers auto--quality best", "bunnies16 auto--quality balanced", "bunnies16 uniform",
          "bunnies16 cloud", "bunnies16 nested", "bunny_stadium octant"})
        EXPECT_EQ(setsOf.count(variant), 1u) << variant;
    for (const auto& [variant, sets] : setsOf) EXPECT_EQ(sets.size(), 4u) << variant;
    EXPECT_FALSE(std::filesystem::exists(out_ + "/work")) << "rays are large and go away";
}

TEST_F(BenchmarkPipeline, DrawsItsResults) {
    if (runCommand({"/bin/sh", "-c", "command -v gnuplot"}).exitCode != 0)
        GTEST_SKIP() << "gnuplot is not installed";
    const CommandResult result = run(RT_BIN_DIR, {"--scenes", "bunny", "--variants", "cloud"});
    ASSERT_EQ(result.exitCode, 0) << result.err;
    for (const std::string name : {"rays", "build"}) {
        EXPECT_THAT(readText(out_ + "/" + name + ".png"), StartsWith("\x89PNG"));
        const std::string svg = readText(out_ + "/" + name + ".svg");
        for (const char* text : {"<svg", "bunny", "cloud", "Embree (CPU)"}) EXPECT_THAT(svg, HasSubstr(text));
    }
    EXPECT_THAT(readText(out_ + "/rays.svg"), HasSubstr("Diffuse rays in random order"));
}

TEST_F(BenchmarkPipeline, WrongHitsFailTheRunAndAreCounted) {
    // Overwrites the first four hits by ones of triangle 0 at t = 0. Its arguments: atlas --rays FILE -o HITS
    // ...
    const std::string tools =
        toolsWithTrace(RT_BIN_DIR "/rt-trace \"$@\" || exit\n"
                                  "[ $# -lt 5 ] || dd if=/dev/zero of=\"$5\" bs=64 count=1 conv=notrunc\n");
    const CommandResult result = run(tools, {"--scenes", "bunny", "--variants", "cloud"});
    EXPECT_EQ(result.exitCode, 1);
    EXPECT_THAT(result.err, HasSubstr("bunny, cloud, primary: 0 lost, 4 extra, 0 wrong"));
    EXPECT_EQ(readCsv(out_ + "/results.csv").at(0).at("extra"), "4");
}

TEST_F(BenchmarkPipeline, ABuildThatFailsIsNotedAndTheOthersGoOn) {
    const CommandResult result =
        run(RT_BIN_DIR, {"--scenes", "bunny", "--variants", "cloud --max-memory 1k", "uniform"});
    EXPECT_EQ(result.exitCode, 1);
    const std::vector<CsvRow> rows = readCsv(out_ + "/results.csv");
    ASSERT_EQ(rows.size(), 5u);
    EXPECT_THAT(rows[0].at("note"), HasSubstr("rt-grid: error: "));
    for (std::size_t i = 1; i < rows.size(); ++i) expectFigures(rows[i]);
}

// Ends as where the shadow rays need more steps than a software renderer does.
const std::string kNoShadowRays = "case \"$*\" in\n"
                                  "--list-devices) echo '0  hardware  GPU'; exit;;\n"
                                  "*shadow.rays*) echo 'rt-trace: error: too many steps' >&2; exit 5;;\n"
                                  "esac\n";

TEST_F(BenchmarkPipeline, WhatASoftwareRendererCannotTraceIsSkippedWithANote) {
    const std::string tools = toolsWithTrace(kNoShadowRays + "exec " RT_BIN_DIR "/rt-trace \"$@\"\n");
    const CommandResult result = run(tools, {"--scenes", "bunny", "--variants", "cloud"});
    EXPECT_EQ(result.exitCode, 0) << result.err;
    const std::vector<CsvRow> rows = readCsv(out_ + "/results.csv");
    ASSERT_EQ(rows.size(), 4u);
    for (const CsvRow& row : rows) {
        if (row.at("set") != "shadow") {
            expectFigures(row);
            continue;
        }
        EXPECT_EQ(row.at("note"), "skipped: rt-trace: error: too many steps");
        EXPECT_EQ(row.at("mrays_per_s"), "");
    }
}

TEST_F(BenchmarkPipeline, OnHardwareALimitIsAFailure) {
    const std::string tools = toolsWithTrace(
        kNoShadowRays + "exec " RT_BIN_DIR "/rt-trace \"$1\" \"$2\" \"$3\" \"$4\" \"$5\" --json \"$9\"\n");
    const CommandResult result =
        run(tools, {"--scenes", "bunny", "--variants", "cloud", "--device", "0", "--repeat", "0"});
    EXPECT_EQ(result.exitCode, 1);
    EXPECT_THAT(result.err, HasSubstr("bunny, cloud: rt-trace: error: too many steps"));
}

TEST_F(BenchmarkPipeline, AnOutputThatIsAFileIsOneLineOfError) {
    std::ofstream(out_) << "a file";
    const CommandResult result = run(RT_BIN_DIR, {"--scenes", "bunny"});
    EXPECT_EQ(result.exitCode, 1);
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_THAT(result.err, HasSubstr("--out " + out_));
}

} // namespace
} // namespace rt::test

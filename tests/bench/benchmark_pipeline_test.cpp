// pipelines/benchmark in its reduced form, on scenes that need no model from elsewhere.
#include "formats/mesh_file.h"
#include "tests/support/make_mesh.h"
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

using testing::AnyOf;
using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;
using testing::UnorderedElementsAre;

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

    CommandResult run(const std::string& tools, const std::vector<std::string>& variables) {
        std::vector<std::string> argv = {"/usr/bin/env", "RT_TOOLS_DIR=" + tools, "/bin/sh",
                                         RT_SOURCE_DIR "/pipelines/benchmark/run.sh", out_};
        for (const std::string& variable :
             {std::string("RT_DEVICES=software"), std::string("RT_SIZE=32"), std::string("RT_REPEAT=0"),
              std::string("RT_EMBREE_REPEAT=1"), "RT_SCENES_DIR=" + folder_.file("scenes")})
            argv.push_back("-D" + variable);
        for (const std::string& variable : variables) argv.push_back("-D" + variable);
        return runCommand(argv);
    }

    // A folder of the tools with this shell script in the place of rt-trace.
    std::string toolsWithTrace(const std::string& script) {
        std::string tools = folder_.file("tools");
        std::filesystem::create_directory(tools);
        for (const char* tool : {"rt-import", "rt-grid", "rt-compare", "rt_make_rays", "rt_check_hits",
                                 "rt_measure_hits", "rt_box_filter"})
            std::filesystem::create_symlink(std::string(RT_BIN_DIR "/") + tool, tools + "/" + tool);
        std::ofstream(tools + "/rt-trace") << "#!/bin/sh\n" << script;
        std::filesystem::permissions(tools + "/rt-trace", std::filesystem::perms::owner_all);
        return tools;
    }

    // As after a run that was cut off before it came to this scene, whose table CMake had begun.
    void expectThatASceneNotComeToIsNamed() {
        std::ofstream(out_ + "/dragon.results.csv")
            << "scene,structure,options,set,atlas,step\n"
               "dragon,cloud,,primary,dragon-cloud,dragon-cloud-primary\n";
        const CommandResult result =
            runCommand({PYTHON_PATH, "-B", RT_SOURCE_DIR "/pipelines/benchmark/collect.py", out_});
        EXPECT_EQ(result.exitCode, 0);
        EXPECT_THAT(result.err, HasSubstr("dragon.results.csv: left out, no run has come to this scene yet"));
        EXPECT_EQ(readCsv(out_ + "/results.csv").back().at("scene"), "slivers");
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
    const CommandResult result = run(RT_BIN_DIR, {"RT_SCENES=slivers;dragon"});
    ASSERT_EQ(result.exitCode, 0) << result.out << result.err;
    EXPECT_THAT(result.err, HasSubstr("dragon: skipped"));
    std::map<std::string, std::set<std::string>> setsOf;
    for (const CsvRow& row : readCsv(out_ + "/results.csv")) {
        expectFigures(row);
        setsOf[row.at("structure") + row.at("options")].insert(row.at("set"));
        EXPECT_EQ(row.at("triangles"), "2000");
    }
    for (const char* variant : {"uniform", "cloud", "octant", "nested", "auto--quality fast",
                                "auto--quality balanced", "auto--quality best"})
        EXPECT_THAT(setsOf[variant], UnorderedElementsAre("primary", "shadow", "diffuse", "random"))
            << variant;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(out_))
        EXPECT_THAT(entry.path().extension().string(), Not(AnyOf(".rays", ".hits", ".rtatlas")))
            << entry.path() << ": what is large goes away";
    expectThatASceneNotComeToIsNamed();
}

TEST_F(BenchmarkPipeline, MadeScenesComeIntoOneTableThatIsDrawn) {
    for (const auto& [scenes, sets] :
         {std::pair("RT_SCENES=bunnies16;bunny_stadium", "RT_SETS=primary;shadow;diffuse;random"),
          std::pair("RT_SCENES=bunny", "RT_SETS=random")}) {
        const CommandResult result = run(RT_BIN_DIR, {scenes, sets, "RT_VARIANTS=nested;cloud --density 4"});
        ASSERT_EQ(result.exitCode, 0) << result.out << result.err;
    }
    std::map<std::string, std::size_t> rowsOf;
    for (const CsvRow& row : readCsv(out_ + "/results.csv")) {
        expectFigures(row);
        ++rowsOf[row.at("scene") + " " + row.at("triangles")];
        if (row.at("set") != "primary") continue;
        EXPECT_EQ(row.at("rays"), "1024");
        EXPECT_GT(std::stoi(row.at("hits")), 20);
    }
    EXPECT_THAT(rowsOf, ElementsAre(std::pair("bunnies16 3202", 8), std::pair("bunny 200", 2),
                                    std::pair("bunny_stadium 210", 8)))
        << "the rows of the first run stay";
    if (runCommand({"/bin/sh", "-c", "command -v gnuplot"}).exitCode != 0)
        GTEST_SKIP() << "gnuplot is not installed";
    for (const std::string name : {"rays", "build"}) {
        EXPECT_THAT(readText(out_ + "/" + name + ".png"), StartsWith("\x89PNG"));
        const std::string svg = readText(out_ + "/" + name + ".svg");
        for (const char* text : {"<svg", "bunny", "bunnies16", "cloud", "Embree (CPU)"})
            EXPECT_THAT(svg, HasSubstr(text));
    }
    EXPECT_THAT(readText(out_ + "/rays.svg"), HasSubstr("Diffuse rays in random order"));
}

TEST_F(BenchmarkPipeline, WrongHitsFailTheRunAndAreCounted) {
    // Overwrites the first four hits by ones of triangle 0 at t = 0. Its arguments: atlas --rays FILE -o HITS
    // ...
    const std::string tools =
        toolsWithTrace(RT_BIN_DIR "/rt-trace \"$@\" || exit\n"
                                  "[ $# -lt 5 ] || dd if=/dev/zero of=\"$5\" bs=64 count=1 conv=notrunc\n");
    // 4 of 1024 are 3906.25 per million.
    const CommandResult result = run(tools, {"RT_SCENES=bunny", "RT_VARIANTS=cloud", "RT_SETS=primary;random",
                                             "RT_ALLOW_PER_MILLION=3906"});
    EXPECT_EQ(result.exitCode, 1);
    EXPECT_THAT(result.err, HasSubstr("bunny, cloud, primary: 0 lost, 4 extra, 0 wrong"));
    EXPECT_THAT(result.err, HasSubstr("bunny, cloud, random: "));
    EXPECT_EQ(readCsv(out_ + "/results.csv").at(0).at("extra"), "4");
    EXPECT_EQ(
        run(tools, {"RT_SCENES=bunny", "RT_VARIANTS=cloud", "RT_SETS=primary", "RT_ALLOW_PER_MILLION=3907"})
            .exitCode,
        0);
}

TEST_F(BenchmarkPipeline, ABuildThatFailsIsNamedAndTheOthersGoOn) {
    const CommandResult result =
        run(RT_BIN_DIR,
            {"RT_SCENES=bunny", "RT_VARIANTS=cloud --max-memory 1k;uniform", "RT_SETS=primary;shadow"});
    EXPECT_EQ(result.exitCode, 1);
    EXPECT_THAT(result.err, HasSubstr("1 failures:\nbunny, cloud --max-memory 1k: rt-grid: error: "));
    const std::vector<CsvRow> rows = readCsv(out_ + "/results.csv");
    ASSERT_EQ(rows.size(), 4u);
    for (std::size_t i = 0; i < 2; ++i) {
        EXPECT_THAT(rows[i].at("note"), HasSubstr("rt-grid: error: "));
        EXPECT_EQ(rows[i].at("mrays_per_s"), "");
    }
    for (std::size_t i = 2; i < 4; ++i) expectFigures(rows[i]);
}

// Walks through 81,920 triangles in one voxel are too long. The model is not there: its mesh will do.
TEST_F(BenchmarkPipeline, WhatASoftwareRendererCannotTraceIsSkippedWithANote) {
    std::filesystem::create_directory(out_);
    writeMesh(out_ + "/dragon.rtmesh", makeSphere(6));
    const CommandResult result =
        run(RT_BIN_DIR,
            {"RT_SCENES=dragon", "RT_VARIANTS=uniform --resolution 1;cloud", "RT_SETS=primary", "RT_SIZE=8"});
    EXPECT_EQ(result.exitCode, 0) << result.err;
    EXPECT_THAT(result.err, HasSubstr("skipped: dragon, uniform --resolution 1, primary: rt-trace: error: "));
    const std::vector<CsvRow> rows = readCsv(out_ + "/results.csv");
    ASSERT_EQ(rows.size(), 2u);
    EXPECT_THAT(rows[0].at("note"), HasSubstr("this software renderer"));
    EXPECT_EQ(rows[0].at("mrays_per_s"), "");
    expectFigures(rows[1]);
}

TEST_F(BenchmarkPipeline, OnHardwareALimitIsAFailure) {
    const std::string tools =
        toolsWithTrace("case \"$*\" in\n"
                       "*--list-devices*) echo '{\"devices\": [{\"index\": 0, \"software\": false, "
                       "\"cudaDevice\": null}]}'; exit;;\n"
                       "*shadow.rays*) echo 'rt-trace: error: too many steps' >&2; exit 5;;\n"
                       "esac\nexec " RT_BIN_DIR "/rt-trace \"$@\"\n");
    const CommandResult result =
        run(tools, {"RT_DEVICES=auto", "RT_SCENES=bunny", "RT_VARIANTS=cloud", "RT_SETS=primary;shadow"});
    EXPECT_EQ(result.exitCode, 1);
    EXPECT_THAT(result.err, HasSubstr("bunny, cloud, shadow: rt-trace: error: too many steps"));
    expectFigures(readCsv(out_ + "/results.csv").at(0));
}

TEST_F(BenchmarkPipeline, WrongCallsAreRefused) {
    EXPECT_THAT(run(RT_BIN_DIR, {"RT_SCENES=bunny;no_such"}).err, HasSubstr("no such scene: no_such"));
    const CommandResult nothing = run(RT_BIN_DIR, {"RT_SCENES=dragon"});
    EXPECT_EQ(nothing.exitCode, 1);
    EXPECT_THAT(nothing.err, HasSubstr("dragon: skipped, without " + folder_.file("scenes/models/statues/")));
    EXPECT_THAT(nothing.err, EndsWith("\nnothing was measured\n"));
    std::filesystem::remove_all(out_);
    std::filesystem::create_directories(out_ + "/bunny-photos");
    EXPECT_THAT(run(RT_BIN_DIR, {"RT_SCENES=bunny"}).err, HasSubstr("files that are none of a benchmark"));
    EXPECT_TRUE(std::filesystem::exists(out_ + "/bunny-photos"));
    std::filesystem::remove_all(out_);
    std::ofstream(out_) << "a file";
    const CommandResult result = run(RT_BIN_DIR, {"RT_SCENES=bunny"});
    EXPECT_EQ(result.exitCode, 1);
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_THAT(result.err, HasSubstr(out_));
}

} // namespace
} // namespace rt::test

// pipelines/thesis, small, on the scenes whose models stand here.
#include "tests/support/read_csv.h"
#include "tests/support/read_text.h"
#include "tests/support/run_command.h"
#include "tests/support/temporary_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>

namespace rt::test {
namespace {

using testing::ContainsRegex;
using testing::EndsWith;
using testing::HasSubstr;
using testing::StartsWith;

using RowsByGrid = std::map<std::string, CsvRow>; // "cloud 32"

RowsByGrid ofCompute(const std::string& path) {
    RowsByGrid found;
    for (const CsvRow& row : readCsv(path))
        if (row.at("kernel") == "compute") found[row.at("structure") + " " + row.at("grid")] = row;
    return found;
}

class ThesisPipeline : public testing::Test {
protected:
    CommandResult measure(const std::string& scenes, const std::vector<std::string>& words = {}) {
        std::vector<std::string> argv = {"/usr/bin/env", "RT_TOOLS_DIR=" RT_BIN_DIR, "/bin/sh",
                                         RT_SOURCE_DIR "/pipelines/thesis/run.sh", out_};
        for (const std::string& word :
             std::vector<std::string>{"RT_SCENES_DIR=" + folder_.file("none"), "RT_DEVICES=software",
                                      "RT_THESIS_SIZES=32", "RT_THESIS_SCENES=" + scenes})
            argv.push_back("-D" + word);
        argv.insert(argv.end(), words.begin(), words.end());
        return runCommand(argv);
    }

    // An rt-trace that does not render the first picture, and puts the camera elsewhere in those of a cloud.
    std::string traceThatFailsAndLooksElsewhere() {
        std::string trace = folder_.file("rt-trace");
        std::ofstream(trace) << "#!/bin/sh\n"
                                "case $3 in *uniform32-compute*) echo planted; exit 70;; "
                                "*cloud32*) set -- \"$@\" --fov 20;; esac\n"
                                "exec " RT_BIN_DIR "/rt-trace \"$@\"\n";
        std::filesystem::permissions(trace, std::filesystem::perms::owner_all);
        return trace;
    }

    void expectThatThePageTakesTheTables() {
        const std::string page = folder_.file("page/README.md");
        std::filesystem::create_directory(folder_.file("page"));
        std::ofstream(page) << "before\n<!-- tables -->\nold\n<!-- end of tables -->\nafter\n";
        const CommandResult drawn =
            runCommand({PYTHON_PATH, "-B", RT_SOURCE_DIR "/pipelines/thesis/figures.py", out_, page});
        EXPECT_EQ(drawn.exitCode, 0) << drawn.err;
        const std::string text = readText(page);
        EXPECT_THAT(text, StartsWith("before\n<!-- tables -->\n" + readText(out_ + "/tables.md")));
        EXPECT_THAT(text, EndsWith("<!-- end of tables -->\nafter\n"));
        EXPECT_EQ(std::filesystem::exists(out_ + "/sparse.png"),
                  std::filesystem::exists(folder_.file("page/sparse.png")));
    }

    // After a run, of which what did not change is taken.
    void expectThatFailuresAndOtherPicturesFailTheRun() {
        const CommandResult result = measure("sparse", {"-DRT_TRACE=" + traceThatFailsAndLooksElsewhere()});
        EXPECT_EQ(result.exitCode, 1);
        EXPECT_THAT(result.out, HasSubstr("FAILED: sparse-uniform32-compute-32.exr"));
        EXPECT_THAT(result.out, ContainsRegex("sparse-cloud32-compute-32-errors [.]+[*]+Failed"));
        EXPECT_THAT(result.out, ContainsRegex("sparse-cloud128-compute-32-errors [.]+ +Passed"));
        RowsByGrid rows = ofCompute(out_ + "/thesis.csv");
        EXPECT_EQ(rows.size(), 5u) << "the others go on";
        EXPECT_GT(std::stod(rows["cloud 32"].at("rmse")), 5e-3);
    }

    // What becomes of the pictures' sizes on this device where rt-trace lists these.
    std::string sizesOn(const std::string& device, const std::string& listed) {
        const std::string trace = folder_.file("rt-trace");
        std::ofstream(trace) << "#!/bin/sh\necho '{\"devices\": [" + listed + "]}'\n";
        std::filesystem::permissions(trace, std::filesystem::perms::owner_all);
        std::filesystem::remove_all(out_);
        const CommandResult result =
            runCommand({CMAKE_PATH, "-G", "Ninja", "-S", RT_SOURCE_DIR "/pipelines/thesis", "-B", out_, "-LA",
                        "-DRT_TOOLS_DIR=" RT_BIN_DIR, "-DRT_TRACE=" + trace, "-DRT_DEVICES=" + device,
                        "-DRT_THESIS_SCENES="});
        EXPECT_EQ(result.exitCode, 0) << result.err;
        const std::string key = "RT_THESIS_SIZES:STRING=";
        const std::size_t start = result.out.find(key) + key.size();
        return result.out.substr(start, result.out.find('\n', start) - start);
    }

    TemporaryFolder folder_;
    const std::string out_ = folder_.file("out");
};

double number(const CsvRow& row, const char* column) {
    return std::stod(row.at(column));
}

TEST_F(ThesisPipeline, MeasuresTheSparseSceneAndFindsWhatTheThesisFound) {
    const CommandResult result = measure("sparse;board");
    ASSERT_EQ(result.exitCode, 0) << result.out << result.err;
    EXPECT_THAT(result.err, HasSubstr("board: skipped, "));
    const std::vector<CsvRow> all = readCsv(out_ + "/thesis.csv");
    ASSERT_EQ(all.size(), 2u * 5u); // kernels, atlases
    for (const CsvRow& row : all) {
        EXPECT_EQ(row.at("triangles"), "12000");
        EXPECT_EQ(row.at("size"), "32");
        EXPECT_GT(number(row, "ms"), 0.0);
        if (&row == &all.front()) continue; // the picture that others are compared with
        EXPECT_LE(number(row, "rmse"), 5e-3);
        EXPECT_LE(number(row, "ids_differing"), 2e-3);
    }
    RowsByGrid rows = ofCompute(out_ + "/thesis.csv");
    ASSERT_EQ(rows.size(), 5u);
    EXPECT_EQ(rows["cloud 32"].at("proximity_max"), "24");
    EXPECT_EQ(rows["cloud 128"].at("proximity_max"), "96");
    for (const std::string grid : {"32", "128"}) {
        const CsvRow &uniform = rows["uniform " + grid], &cloud = rows["cloud " + grid];
        EXPECT_LT(number(cloud, "steps_per_ray"), 0.2 * number(uniform, "steps_per_ray")) << grid;
        EXPECT_EQ(cloud.at("tests_per_ray"), uniform.at("tests_per_ray")) << grid;
        EXPECT_EQ(cloud.at("structure_bytes"), uniform.at("structure_bytes")) << grid;
        EXPECT_EQ(cloud.at("rays"), "1024");
    }
    EXPECT_LT(number(rows["ours "], "steps_per_ray"), number(rows["cloud 128"], "steps_per_ray"));
    const std::string tables = readText(out_ + "/tables.md");
    EXPECT_THAT(tables, HasSubstr("| sparse scene, 128³ | more than 50 % | "));
    EXPECT_THAT(tables, HasSubstr("| sparse | 12,000 | 32³ | 98."));
    expectThatThePageTakesTheTables();
    expectThatFailuresAndOtherPicturesFailTheRun();
    if (runCommand({"/bin/sh", "-c", "command -v gnuplot"}).exitCode != 0)
        GTEST_SKIP() << "gnuplot is not installed";
    for (const std::string name : {"scenes", "sparse"})
        EXPECT_THAT(readText(out_ + "/" + name + ".png"), StartsWith("\x89PNG"));
    EXPECT_THAT(readText(out_ + "/sparse.svg"), HasSubstr("steps per ray"));
}

TEST_F(ThesisPipeline, FullSizesAreForAGpuThatCanBeUsed) {
    const std::string software = R"({"index": 1, "software": true, "cudaDevice": null})";
    const std::string gpu = R"({"index": 0, "software": false, "cudaDevice": 3}, )" + software;
    const std::string broken =
        R"({"index": 0, "software": false, "problem": "0  hardware  of old"}, )" + software;
    for (const char* device : {"auto", "0", "cuda:3", "cuda:3,1"})
        EXPECT_EQ(sizesOn(device, gpu), "256;512;1024") << device;
    for (const char* device : {"software", "1"}) EXPECT_EQ(sizesOn(device, gpu), "64") << device;
    EXPECT_EQ(sizesOn("auto", broken), "64");
    EXPECT_EQ(sizesOn("auto", ""), "64");
}

TEST_F(ThesisPipeline, MeshesThatAreThereAreTakenAsTheyAre) {
    std::filesystem::create_directories(out_);
    std::ofstream(out_ + "/board.rtmesh") << "no mesh";
    const CommandResult result = measure("board");
    EXPECT_EQ(result.exitCode, 1);
    EXPECT_THAT(result.out, HasSubstr("rt-grid: error: "));
    EXPECT_THAT(result.err, HasSubstr("not measured: board ours multipass 32"));
}

TEST_F(ThesisPipeline, WithoutModelsAndWithUnknownScenesNothingIsMeasured) {
    const CommandResult skipped = measure("board;sponza");
    EXPECT_EQ(skipped.exitCode, 1);
    EXPECT_THAT(skipped.err, HasSubstr("sponza: skipped, "));
    for (const std::string scene : {"bord", "GRIDS"}) { // the second is a keyword of the scenes' options
        const CommandResult unknown = measure("sparse;" + scene);
        EXPECT_EQ(unknown.exitCode, 1);
        EXPECT_THAT(unknown.err, HasSubstr("no such scene: " + scene));
    }
}

} // namespace
} // namespace rt::test

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
    CommandResult measure(const std::string& tools, const std::vector<std::string>& scenes) {
        std::vector<std::string> argv = {PYTHON_PATH, "-B", RT_SOURCE_DIR "/pipelines/thesis/measure.py"};
        for (const std::string& word :
             std::vector<std::string>{"--tools", tools, "--out", out_, "--scenes-dir", folder_.file("none"),
                                      "--device", "software", "--size", "32", "--repeat", "0", "--scenes"})
            argv.push_back(word);
        argv.insert(argv.end(), scenes.begin(), scenes.end());
        return runCommand(argv);
    }

    // A folder of the tools with an rt-trace that puts the camera elsewhere when it looks through a cloud.
    std::string toolsThatLookElsewhere() {
        std::string tools = folder_.file("tools");
        std::filesystem::create_directory(tools);
        for (const char* tool : {"rt-import", "rt-grid", "rt-compare"})
            std::filesystem::create_symlink(std::string(RT_BIN_DIR "/") + tool, tools + "/" + tool);
        std::ofstream(tools + "/rt-trace") << "#!/bin/sh\n"
                                              "case $1 in *cloud32*) set -- \"$@\" --fov 20;; esac\n"
                                              "exec " RT_BIN_DIR "/rt-trace \"$@\"\n";
        std::filesystem::permissions(tools + "/rt-trace", std::filesystem::perms::owner_all);
        return tools;
    }

    // After a run, whose meshes are taken.
    void expectThatOtherPicturesFail() {
        const CommandResult result = measure(toolsThatLookElsewhere(), {"sparse"});
        EXPECT_EQ(result.exitCode, 1);
        EXPECT_THAT(result.err, HasSubstr("sparse, cloud32, compute, 32: RMSE "));
        EXPECT_THAT(result.err, testing::Not(HasSubstr("cloud128, compute, 32: RMSE")));
        EXPECT_EQ(ofCompute(out_ + "/thesis.csv").size(), 5u) << "the others go on";
    }

    TemporaryFolder folder_;
    const std::string out_ = folder_.file("out");
};

double number(const CsvRow& row, const char* column) {
    return std::stod(row.at(column));
}

TEST_F(ThesisPipeline, MeasuresTheSparseSceneAndFindsWhatTheThesisFound) {
    const CommandResult result = measure(RT_BIN_DIR, {"sparse", "board"});
    ASSERT_EQ(result.exitCode, 0) << result.err;
    EXPECT_THAT(result.err, HasSubstr("board: skipped, "));
    for (const CsvRow& row : readCsv(out_ + "/thesis.csv")) {
        EXPECT_EQ(row.at("triangles"), "12000");
        EXPECT_EQ(row.at("size"), "32");
        EXPECT_EQ(row.at("note"), "");
        EXPECT_GT(number(row, "ms"), 0.0);
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
    expectThatOtherPicturesFail();
    if (runCommand({"/bin/sh", "-c", "command -v gnuplot"}).exitCode != 0)
        GTEST_SKIP() << "gnuplot is not installed";
    for (const std::string name : {"scenes", "sparse"})
        EXPECT_THAT(readText(out_ + "/" + name + ".png"), StartsWith("\x89PNG"));
    EXPECT_THAT(readText(out_ + "/sparse.svg"), HasSubstr("steps per ray"));
}

TEST_F(ThesisPipeline, MeshesThatAreThereAreTakenAsTheyAre) {
    std::filesystem::create_directories(out_ + "/meshes");
    std::ofstream(out_ + "/meshes/board.rtmesh") << "no mesh";
    const CommandResult result = measure(RT_BIN_DIR, {"board"});
    EXPECT_EQ(result.exitCode, 1);
    EXPECT_THAT(result.err, HasSubstr("rt-grid: error: "));
}

} // namespace
} // namespace rt::test

// pipelines/benchmark/run.sh error in its reduced form, on a scene that needs no model from elsewhere.
#include "tests/support/make_mesh.h"
#include "tests/support/read_csv.h"
#include "tests/support/read_text.h"
#include "tests/support/run_command.h"
#include "tests/support/temporary_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

namespace rt::test {
namespace {

using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

class ErrorPipeline : public testing::Test {
protected:
    // A torus stands in for the bunny: curved, and rays that start on it may hit it.
    ErrorPipeline() {
        const Mesh mesh = makeTorus(1.0f, 0.5f, 48, 24);
        const std::string path = folder_.file("scenes/models/statues/bun_zipper.ply");
        std::filesystem::create_directories(std::filesystem::path(path).parent_path());
        std::ofstream file(path);
        file << "ply\nformat ascii 1.0\nelement vertex " << mesh.positions.size()
             << "\nproperty float x\nproperty float y\nproperty float z\nelement face "
             << mesh.triangles.size() << "\nproperty list uchar int vertex_indices\nend_header\n";
        for (const glm::vec3& p : mesh.positions) file << p.x << ' ' << p.y << ' ' << p.z << '\n';
        for (const glm::uvec3& t : mesh.triangles) file << "3 " << t.x << ' ' << t.y << ' ' << t.z << '\n';
    }

    CommandResult run(const std::vector<std::string>& variables) {
        std::vector<std::string> argv = {"/usr/bin/env",
                                         "RT_TOOLS_DIR=" RT_BIN_DIR,
                                         "/bin/sh",
                                         RT_SOURCE_DIR "/pipelines/benchmark/run.sh",
                                         "error",
                                         out_,
                                         "-DRT_DEVICES=software",
                                         "-DRT_SCENES=bunny",
                                         "-DRT_SIZE=64",
                                         "-DRT_REPEAT=0",
                                         "-DRT_PICTURE_SIZE=16",
                                         "-DRT_SCENES_DIR=" + folder_.file("scenes")};
        for (const std::string& variable : variables) argv.push_back("-D" + variable);
        return runCommand(argv);
    }

    TemporaryFolder folder_;
    const std::string out_ = folder_.file("out");
};

double number(const CsvRow& row, const std::string& column) {
    return std::stod(row.at(column));
}

// A row of rays: the reference itself has no error, double precision nearly none, float some.
void expectErrors(const CsvRow& row) {
    const bool isDouble = row.at("precision") == "double";
    const bool isReference =
        isDouble && row.at("intersect") == "watertight" && row.at("structure") == "nested";
    EXPECT_GT(number(row, "rays"), 500.0);
    EXPECT_GT(number(row, "compared"), 50.0);
    EXPECT_GT(number(row, "mrays_per_s"), 0.0);
    EXPECT_LT(number(row, "leak_rate") + number(row, "wrong_triangle_rate"), 0.01);
    for (const std::string error : {"t", "position", "normal"}) {
        const double median = number(row, error + "_median"), p999 = number(row, error + "_p999");
        EXPECT_LE(median, p999);
        EXPECT_LE(p999, number(row, error + "_max"));
        if (isReference) {
            EXPECT_EQ(number(row, error + "_max"), 0.0) << error;
        } else if (isDouble) {
            EXPECT_LT(median, 1e-12) << error;
        } else {
            EXPECT_GT(median, 0.0) << error;
            EXPECT_LT(p999, 1e-3) << error;
        }
    }
}

TEST_F(ErrorPipeline, MeasuresRaysAndPicturesAgainstDoublePrecision) {
    const CommandResult result = run({"RT_VARIANTS=nested;cloud", "RT_SETS=primary;diffuse",
                                      "RT_INTERSECTS=watertight;moller-trumbore", "RT_SPP_SIDES=1;2"});
    ASSERT_EQ(result.exitCode, 0) << result.out << result.err;

    const std::vector<CsvRow> errors = readCsv(out_ + "/errors.csv");
    EXPECT_EQ(errors.size(), 2u * 2u * 2u * 2u); // structures, tests, precisions, sets
    for (const CsvRow& row : errors) {
        SCOPED_TRACE(row.at("structure") + " " + row.at("intersect") + " " + row.at("precision"));
        expectErrors(row);
    }

    const std::vector<CsvRow> pictures = readCsv(out_ + "/pictures.csv");
    ASSERT_EQ(pictures.size(), 2u * 2u * 2u); // tests, precisions, samples
    for (const CsvRow& row : pictures) {
        EXPECT_GT(number(row, "ms"), 0.0);
        const bool isReference = row.at("precision") == "double" && row.at("intersect") == "watertight";
        if (row.at("spp") == "1") {
            EXPECT_GT(number(row, "rmse"), 1e-4);
        } else if (isReference) {
            EXPECT_EQ(row.at("rmse"), "0");
        } else {
            EXPECT_LT(number(row, "rmse"), number(pictures[0], "rmse"));
        }
    }
    const std::string page = readText(out_ + "/errors.html");
    EXPECT_THAT(page, HasSubstr("moller-trumbore"));
    EXPECT_THAT(page, Not(HasSubstr("http"))) << "the page needs nothing from elsewhere";
    if (runCommand({"/bin/sh", "-c", "command -v gnuplot"}).exitCode != 0)
        GTEST_SKIP() << "gnuplot is not installed";
    for (const std::string name : {"errors", "pictures"}) {
        EXPECT_THAT(readText(out_ + "/" + name + ".png"), StartsWith("\x89PNG"));
        EXPECT_THAT(readText(out_ + "/" + name + ".svg"), HasSubstr("<svg"));
    }
    EXPECT_THAT(page, HasSubstr("<svg"));
}

TEST_F(ErrorPipeline, DensitiesAreVariantsAndFailuresAreNoted) {
    const CommandResult result = run({"RT_VARIANTS=cloud --density 4;cloud --density 1e10",
                                      "RT_INTERSECTS=watertight", "RT_PRECISIONS=float", "RT_SPP_SIDES=1"});
    EXPECT_EQ(result.exitCode, 1);
    EXPECT_THAT(result.err, HasSubstr("1 failures:\nbunny, cloud --density 1e10: rt-grid: error: "));
    const std::vector<CsvRow> errors = readCsv(out_ + "/errors.csv");
    ASSERT_EQ(errors.size(), 2u);
    EXPECT_EQ(errors[0].at("options"), "--density 4");
    expectErrors(errors[0]);
    EXPECT_THAT(errors[1].at("note"), HasSubstr("--density"));
}

// What Python says of an expression in which `error_plot` is known.
std::string evaluate(const std::string& expression) {
    return runCommand({PYTHON_PATH, "-B", "-c",
                       "import sys; sys.path += ['" RT_SOURCE_DIR "/pipelines', '" RT_SOURCE_DIR
                       "/pipelines/benchmark']; import error_plot; print(" +
                           expression + ")"})
        .out;
}

TEST(ErrorPlot, TheFrontIsWhatNothingBeatsInBoth) {
    EXPECT_EQ(evaluate("error_plot.pareto_front([(3, 4), (2, 3), (2, 5), (1, 1), (1.5, 1), (0, 0.5)])"),
              "[(0, 0.5), (1, 1), (2, 5)]\n");
    EXPECT_EQ(evaluate("error_plot.pareto_front([])"), "[]\n");
}

TEST(ErrorPlot, ZeroStandsBelowAllOtherErrors) {
    EXPECT_EQ(evaluate("[error_plot.Axis([0.0, 1e-7, 1e-6]).place(v) for v in (0.0, 1e-7)]"),
              "[1e-08, 1e-07]\n");
    EXPECT_EQ(evaluate("error_plot.Axis([0.0, 0.0]).commands('x')[2]"), "set xtics nomirror ('0' 0.1)\n");
}

} // namespace
} // namespace rt::test

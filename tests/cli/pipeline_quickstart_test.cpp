// The pipeline of quickstart.sh, copied so that touching its model leaves the sources alone.
#include "tests/support/run_command.h"
#include "tests/support/temporary_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

namespace rt::test {
namespace {

using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;

class Quickstart : public testing::Test {
protected:
    Quickstart() {
        std::filesystem::copy(RT_SOURCE_DIR "/pipelines", folder_.file("pipelines"),
                              std::filesystem::copy_options::recursive);
    }

    CommandResult configure() {
        return runCommand({CMAKE_PATH, "-G", "Ninja", "-S", folder_.file("pipelines/quickstart"), "-B", work_,
                           "-DRT_TOOLS_DIR=" RT_BIN_DIR, "-DRT_QUICKSTART_SIZE=96x96",
                           "-DRT_DEVICES=software"});
    }
    CommandResult build() { return runCommand({CMAKE_PATH, "--build", work_, "--", "-v"}); }

    TemporaryFolder folder_;
    const std::string work_ = folder_.file("build");
};

void expectTable(const CommandResult& table) {
    EXPECT_EQ(table.exitCode, 0) << table.err;
    EXPECT_THAT(table.out, ContainsRegex("triangles +56,576 +56,576\n"));
    EXPECT_THAT(table.out, ContainsRegex("cells +[0-9]+ x [0-9]+ x [0-9]+ +[0-9]+ x [0-9]+ x [0-9]+\n"));
    EXPECT_THAT(table.out, ContainsRegex("atlas bytes +[0-9,]{7,} +[0-9,]{7,}\n"));
    for (const std::string row : {"build ms", "render ms", "Mrays/s", "steps per ray"})
        EXPECT_THAT(table.out, ContainsRegex(row + " +[0-9]+[.][0-9]+ +[0-9]+[.][0-9]+\n"));
    EXPECT_THAT(table.out, ContainsRegex("RMSE +reference +[0-9.e-]+\n"));
    EXPECT_THAT(table.out, HasSubstr("verdict        pass"));
}

TEST_F(Quickstart, PrintsItsTableAndThenRunsOnlyWhatATouchedModelNeeds) {
    ASSERT_EQ(configure().exitCode, 0);
    const CommandResult first = build();
    ASSERT_EQ(first.exitCode, 0) << first.out << first.err;
    EXPECT_EQ(runCommand({CTEST_PATH, "--test-dir", work_}).exitCode, 0);
    expectTable(runCommand({PYTHON_PATH, folder_.file("pipelines/quickstart/print_table.py"), work_}));
    for (const char* picture : {"uniform_view.png", "cloud_view.png", "uniform_view.exr", "cloud_view.exr"})
        EXPECT_TRUE(std::filesystem::exists(work_ + "/" + picture)) << picture;

    const CommandResult again = build();
    EXPECT_THAT(again.out, HasSubstr("no work to do"));
    EXPECT_LT(again.processorSeconds, 3.0);

    std::filesystem::last_write_time(folder_.file("pipelines/quickstart/poolTable/poolTable.obj"),
                                     std::filesystem::file_time_type::clock::now());
    const CommandResult touched = build();
    EXPECT_EQ(touched.exitCode, 0) << touched.out << touched.err;
    EXPECT_THAT(touched.out, HasSubstr("rt-import"));
    for (const char* tool : {"rt-grid", "rt-trace", "rt-compare"})
        EXPECT_THAT(touched.out, Not(HasSubstr(tool)));
    EXPECT_THAT(build().out, HasSubstr("no work to do"));
}

} // namespace
} // namespace rt::test

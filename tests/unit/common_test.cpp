// Outputs appear whole or not at all, and keep their time stamp when nothing changed.
#include "common/binary_io.h"
#include "common/command_line.h"
#include "common/error.h"
#include "common/run_tool.h"
#include "common/stage_timer.h"
#include "tests/support/read_text.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <sys/stat.h>
#include <thread>
#include <unistd.h>

namespace rt {
namespace {

TEST(WriteFile, ReplacesAndLeavesNothingElseBehind) {
    const test::TemporaryFolder folder;
    writeFile(folder.file("a"), std::string_view("one"));
    writeFile(folder.file("a"), std::string_view("another"));
    EXPECT_EQ(test::readText(folder.file("a")), "another");
    EXPECT_EQ(folder.entryCount(), 1u);
}

TEST(WriteFile, KeepsTheTimeStampOfSameContent) {
    namespace fs = std::filesystem;
    const test::TemporaryFolder folder;
    writeFile(folder.file("a"), std::string_view("same"));
    const auto old = fs::file_time_type::clock::now() - std::chrono::hours(1);
    fs::last_write_time(folder.file("a"), old);
    const auto before = fs::last_write_time(folder.file("a"));
    writeFile(folder.file("a"), std::string_view("same"));
    EXPECT_EQ(fs::last_write_time(folder.file("a")), before);
    writeFile(folder.file("a"), std::string_view("Same"));
    EXPECT_NE(fs::last_write_time(folder.file("a")), before);
}

TEST(WriteFile, KeepsPermissionsAndSymbolicLinks) {
    namespace fs = std::filesystem;
    const test::TemporaryFolder folder;
    writeFile(folder.file("a"), std::string_view("old"));
    fs::permissions(folder.file("a"), fs::perms::owner_read | fs::perms::owner_write);
    fs::create_symlink("a", folder.file("link"));
    writeFile(folder.file("link"), std::string_view("new"));
    EXPECT_TRUE(fs::is_symlink(folder.file("link")));
    EXPECT_EQ(test::readText(folder.file("a")), "new");
    EXPECT_EQ(fs::status(folder.file("a")).permissions(), fs::perms::owner_read | fs::perms::owner_write);
}

TEST(WriteFile, KeepsPermissionsThatTheUmaskWouldTake) {
    const test::TemporaryFolder folder;
    const mode_t before = umask(022);
    writeFile(folder.file("a"), std::string_view("old"));
    chmod(folder.file("a").c_str(), 0664);
    writeFile(folder.file("a"), std::string_view("new"));
    writeFile(folder.file("fresh"), std::string_view("new"));
    umask(before);
    struct stat info {};
    ASSERT_EQ(stat(folder.file("a").c_str(), &info), 0);
    EXPECT_EQ(info.st_mode & 07777, 0664u);
    ASSERT_EQ(stat(folder.file("fresh").c_str(), &info), 0);
    EXPECT_EQ(info.st_mode & 07777, 0644u);
}

TEST(WriteFile, StaleTemporaryFilesOfAKilledProcessDoNotBlockIt) {
    const test::TemporaryFolder folder;
    const std::string stale = folder.file("a") + ".tmp." + std::to_string(getpid());
    for (const char* name : {"", ".0", ".1"}) std::ofstream(stale + name) << "stale";
    writeFile(folder.file("a"), std::string_view("new"));
    EXPECT_EQ(test::readText(folder.file("a")), "new");
    EXPECT_EQ(test::readText(stale + ".0"), "stale");
    EXPECT_EQ(folder.entryCount(), 4u);
}

TEST(WriteFile, OfSeveralFilesAllAreWrittenOrNone) {
    const test::TemporaryFolder folder;
    writeFile(folder.file("b"), std::string_view("old"));
    const std::string_view text = "new";
    const auto output = [&](const std::string& path) {
        return OutputFile{path, {std::as_bytes(std::span(text))}};
    };
    // No file can be made in /proc, whatever rights one has.
    EXPECT_THROW(writeFiles({output(folder.file("a")), output(folder.file("b")), output("/proc/none")}),
                 Error);
    EXPECT_EQ(test::readText(folder.file("b")), "old");
    EXPECT_EQ(folder.entryCount(), 1u);
    writeFiles({output(folder.file("a")), output("/dev/null"), output(folder.file("b"))});
    EXPECT_EQ(test::readText(folder.file("a")), "new");
    EXPECT_EQ(test::readText(folder.file("b")), "new");
    EXPECT_EQ(folder.entryCount(), 2u);
}

TEST(WriteFile, MissingFolderIsAFileAccessError) {
    const test::TemporaryFolder folder;
    try {
        writeFile(folder.file("none/a"), std::string_view("x"));
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::FileAccess);
        EXPECT_NE(std::string(error.what()).find("none/a"), std::string::npos);
    }
}

TEST(ReadFile, MissingFileAndFolderAreFileAccessErrors) {
    const test::TemporaryFolder folder;
    EXPECT_THROW(readFile(folder.file("none")), Error);
    EXPECT_THROW(readFile(folder.file("")), Error);
}

std::optional<ErrorKind> failureOfReading(const std::string& path, const StreamRule& rule) {
    try {
        readFile(path, rule);
    } catch (const Error& error) {
        EXPECT_EQ(std::string(error.what()).rfind(path + ": ", 0), 0u) << error.what();
        return error.kind();
    }
    return std::nullopt;
}

TEST(ReadFile, StreamsWithoutAnEndAreReadAsFarAsTheirHeadSays) {
    const auto says = [](std::uint64_t length) {
        return StreamRule{64,
                          [length](std::span<const std::byte> head) -> std::optional<std::uint64_t> {
                              EXPECT_EQ(head.size(), 64u);
                              return length;
                          },
                          {}};
    };
    for (const std::uint64_t length : {0u, 64u, 65u, 3u << 20})
        EXPECT_EQ(readFile("/dev/zero", says(length)).size(), std::max<std::uint64_t>(64, length + 1));
    EXPECT_EQ(failureOfReading("/dev/zero", says(~std::uint64_t(0))), ErrorKind::LimitExceeded);
    EXPECT_EQ(failureOfReading("/dev/zero", {8,
                                             [](auto) -> std::optional<std::uint64_t> {
                                                 throw Error(ErrorKind::InvalidContent,
                                                             "/dev/zero: is no such file");
                                             },
                                             {}}),
              ErrorKind::InvalidContent);
}

TEST(ReadFile, StreamsWithoutAnEndStopAtTheMemoryLimit) {
    StreamRule rule;
    rule.memory = {3u << 20, "test"};
    EXPECT_EQ(failureOfReading("/dev/zero", rule), ErrorKind::LimitExceeded);
    EXPECT_TRUE(readFile("/dev/null", rule).empty());
}

TEST(ReadFile, StreamsAreReadWhole) {
    const test::TemporaryFolder folder;
    const std::string pipe = folder.file("pipe");
    ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
    std::string text(5u << 20, 'x');
    for (std::size_t i = 0; i < text.size(); i += 1000) text[i] = static_cast<char>('a' + i / 1000 % 26);
    std::thread writer([&] { std::ofstream(pipe) << text; });
    StreamRule rule;
    rule.memory = {text.size(), "test"}; // just enough
    const SharedSpan<std::byte> bytes = readFile(pipe, rule);
    writer.join();
    EXPECT_EQ(std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()), text);
}

// A body reads a mapped file that has become shorter since.
int readShrunkFile(int, const char* const* argv) {
    writeFile(argv[0], std::string(1u << 16, 'x'));
    const auto bytes = readFile(argv[0]);
    std::filesystem::resize_file(argv[0], 0);
    return static_cast<int>(bytes[5000]);
}

TEST(RunTool, AnInputThatShrinksWhileItIsReadIsOneLineAndAFileAccessError) {
    const test::TemporaryFolder folder;
    std::string path = folder.file("a");
    char* arguments[] = {path.data(), nullptr};
    EXPECT_EXIT(std::_Exit(runTool("rt-x", 1, arguments, readShrunkFile)), testing::ExitedWithCode(3),
                "^rt-x: error: an input file changed while it was read\n$");
}

int stopOneself(int, const char* const*) {
    raise(SIGTERM);
    return 0;
}

TEST(RunTool, SignalsEndTheToolAsEver) {
    EXPECT_EXIT(std::_Exit(runTool("rt-x", 0, nullptr, stopOneself)), testing::KilledBySignal(SIGTERM), "^$");
}

TEST(RequireWritable, FindsMissingFoldersAndFoldersAndTouchesNothing) {
    const test::TemporaryFolder folder;
    EXPECT_THROW(requireWritable(folder.file("none/a")), Error);
    EXPECT_THROW(requireWritable(folder.file("")), Error);
    for (const std::string& path :
         {folder.file("a"), std::string("a"), std::string("-"), std::string("/dev/null")})
        EXPECT_NO_THROW(requireWritable(path)) << path;
    EXPECT_EQ(folder.entryCount(), 0u);
}

TEST(DistinctPaths, OutputsAreNeitherInputsNorEachOther) {
    const test::TemporaryFolder folder;
    const std::string a = folder.file("a"), link = folder.file("link");
    const std::string fresh = folder.file("fresh"), spelled = folder.file("./fresh");
    writeFile(a, std::string_view("one"));
    std::filesystem::create_symlink("a", link);
    EXPECT_NO_THROW(requireDistinctPaths({a, a, "-"}, {fresh, "-", "", "", "/dev/null", "/dev/null"}));
    for (const std::vector<std::string>& outputs : std::vector<std::vector<std::string>>{
             {a}, {link}, {fresh, spelled}, {"new", "./new"}, {"-", fresh, "-"}, {folder.file("sub/../a")}}) {
        try {
            requireDistinctPaths({a}, outputs);
            ADD_FAILURE() << outputs[0];
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::Usage);
        }
    }
    EXPECT_THROW(requireDistinctPaths({}, {a, link}), Error);
    EXPECT_THROW(requireDistinctPaths({fresh}, {spelled}), Error); // the input does not exist
}

TEST(UpToDate, IsWhereEveryOutputIsMadeButTheDependencyFile) {
    CommonOptions options;
    options.depfilePath = "d";
    std::vector<std::string> asked;
    const auto isMade = [&](const std::string& output) {
        asked.push_back(output);
        return output != "old";
    };
    EXPECT_FALSE(isUpToDate(options, {"a"}, isMade)) << "nobody asked";
    EXPECT_TRUE(asked.empty());
    options.ifChanged = true;
    EXPECT_TRUE(isUpToDate(options, {"a", "d", "b"}, isMade));
    EXPECT_EQ(asked, (std::vector<std::string>{"a", "b"}));
    EXPECT_FALSE(isUpToDate(options, {"a", "old"}, isMade));
}

TEST(ParseNumbers, TakesExactlyWhatItSays) {
    EXPECT_EQ(parseNumbers("1,-2.5,3e2", 3, "--eye"), (std::vector<double>{1.0, -2.5, 300.0}));
    for (const char* bad : {"", "1,2", "1,2,3,4", "1,2,x", "1,,3", "1,2,nan", "1,2,inf", "1,2,3 "})
        EXPECT_THROW(parseNumbers(bad, 3, "--eye"), Error) << bad;
}

TEST(ParseSizes, TakesExactlyWhatItSays) {
    EXPECT_EQ(parseSizes("64", 3, "--resolution"), (std::vector<unsigned>{64, 64, 64}));
    EXPECT_EQ(parseSizes("1x22x333", 3, "--resolution"), (std::vector<unsigned>{1, 22, 333}));
    for (const char* bad : {"", "0", "1x2", "1x2x3x4", "-1", "1x2x", "99999999999"})
        EXPECT_THROW(parseSizes(bad, 3, "--resolution"), Error) << bad;
}

TEST(ParseByteSize, TakesSuffixes) {
    EXPECT_EQ(parseByteSize("1000", "--max-memory"), 1000u);
    EXPECT_EQ(parseByteSize("3K", "--max-memory"), 3072u);
    EXPECT_EQ(parseByteSize("800M", "--max-memory"), 800u << 20);
    EXPECT_EQ(parseByteSize("12G", "--max-memory"), std::uint64_t(12) << 30);
    EXPECT_EQ(parseByteSize("1T", "--max-memory"), std::uint64_t(1) << 40);
    EXPECT_EQ(parseByteSize("2k", "--max-memory"), 2048u);
    EXPECT_EQ(parseByteSize("7g", "--max-memory"), std::uint64_t(7) << 30);
    for (const char* text : {"", "G", "0", "-1", "1.5G", "1P", "1TT", "12GB", "99999999999G", "4 G"})
        EXPECT_THROW(parseByteSize(text, "--max-memory"), Error) << text;
}

TEST(Depfile, EscapesWhatMakeWouldRead) {
    EXPECT_EQ(depfileText("out file", {"a b.obj", "c$d.mtl"}),
              "out\\ file: \\\n  a\\ b.obj \\\n  c$$d.mtl\n");
    EXPECT_EQ(depfileText("C:x", {"#1|2", "a\\b", "a\\ b", "100%", "t\t"}),
              "C\\:x: \\\n  \\#1\\|2 \\\n  a\\b \\\n  a\\\\\\ b \\\n  100% \\\n  t\\\t\n");
}

TEST(Stages, ThatRunAgainAddUpWhereTheyFirstRan) {
    StageTimer stages;
    stages.begin("a");
    stages.begin("b");
    stages.begin("a");
    stages.end();
    stages.end();
    stages.add("b", 1000.0);
    stages.add("c", 1.0);
    ASSERT_EQ(stages.stagesMs().size(), 3u);
    EXPECT_EQ(stages.stagesMs()[0].first, "a");
    EXPECT_EQ(stages.stagesMs()[1].first, "b");
    EXPECT_GE(stages.stagesMs()[1].second, 1000.0);
    EXPECT_GT(stages.totalMs(), 1001.0);
}

TEST(StageTimer, saysWhichStageRunsAndHowFarItIs) {
    StageTimer timer;
    EXPECT_EQ(timer.runningText(), "");
    timer.begin("bin");
    EXPECT_EQ(timer.runningText().rfind("bin, ", 0), 0u) << timer.runningText();
    timer.meter().begin(8);
    timer.meter().add(3);
    EXPECT_EQ(timer.runningText().rfind("bin 37 %, ", 0), 0u) << timer.runningText();
    timer.meter().add(9);
    EXPECT_EQ(timer.runningText().rfind("bin 100 %, ", 0), 0u) << timer.runningText();
    timer.begin("boxes");
    EXPECT_EQ(timer.runningText().rfind("boxes, ", 0), 0u) << timer.runningText();
    timer.end();
    EXPECT_EQ(timer.runningText(), "");
    EXPECT_EQ(timer.stagesMs().size(), 2u);
}

} // namespace
} // namespace rt

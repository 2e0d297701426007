// Outputs appear whole or not at all, and keep their time stamp when nothing changed.
#include "common/binary_io.h"
#include "common/command_line.h"
#include "common/error.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <sys/stat.h>

namespace rt {
namespace {

std::string textOf(const std::string& path) {
    const auto bytes = readFile(path);
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

TEST(WriteFile, ReplacesAndLeavesNothingElseBehind) {
    const test::TemporaryFolder folder;
    writeFile(folder.file("a"), std::string_view("one"));
    writeFile(folder.file("a"), std::string_view("another"));
    EXPECT_EQ(textOf(folder.file("a")), "another");
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
    EXPECT_EQ(textOf(folder.file("a")), "new");
    EXPECT_EQ(fs::status(folder.file("a")).permissions(), fs::perms::owner_read | fs::perms::owner_write);
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

TEST(Depfile, EscapesWhatMakeWouldRead) {
    const test::TemporaryFolder folder;
    writeDepfile(folder.file("d"), "out file", {"a b.obj", "c$d.mtl"});
    EXPECT_EQ(textOf(folder.file("d")), "out\\ file: \\\n  a\\ b.obj \\\n  c$$d.mtl\n");
}

} // namespace
} // namespace rt

// Every model of the scene collection, sound or broken, through rt-import as a user runs it.
#include "tests/support/read_text.h"
#include "tests/support/run_command.h"
#include "tests/support/scenes.h"
#include "tests/support/temporary_folder.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

namespace rt {
namespace {

using test::CommandResult;
using Row = std::map<std::string, std::string>; // by the name of the column

std::vector<std::string> cellsOf(const std::string& line) {
    std::vector<std::string> cells;
    std::istringstream text(line);
    for (std::string cell; std::getline(text, cell, '\t');) cells.push_back(cell);
    return cells;
}

// The rows of a table whose first line names the columns; none if the file is absent.
std::vector<Row> readTable(const std::string& path) {
    std::ifstream file(path);
    std::vector<Row> rows;
    std::string line;
    if (!std::getline(file, line)) return rows;
    const std::vector<std::string> names = cellsOf(line);
    while (std::getline(file, line)) {
        const std::vector<std::string> cells = cellsOf(line);
        Row row;
        for (std::size_t i = 0; i < std::min(names.size(), cells.size()); ++i) row[names[i]] = cells[i];
        rows.push_back(row);
    }
    return rows;
}

// Options that let rt-import read the file, if a loader of that extension exists.
std::vector<std::string> allowanceFor(const std::string& path) {
    static const std::string formats = test::runCommand({RT_BIN_DIR "/rt-import", "--list-formats"}).out;
    std::string extension = std::filesystem::path(path).extension().string().substr(1);
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    std::istringstream lines(formats);
    for (std::string line, name, how; std::getline(lines, line);) {
        std::istringstream(line) >> name >> how;
        if (name == extension && how == "--allow-format") return {"--allow-format", extension};
    }
    return {};
}

CommandResult importFile(const std::string& path, const test::TemporaryFolder& folder) {
    std::vector<std::string> command{RT_BIN_DIR "/rt-import",   path,     "-o",
                                     folder.file("out.rtmesh"), "--json", folder.file("out.json")};
    for (const std::string& option : allowanceFor(path)) command.push_back(option);
    return test::runCommand(command);
}

std::uint64_t droppedTriangles(const nlohmann::json& report) {
    std::uint64_t count = 0;
    for (const nlohmann::json& entry : report["ledger"])
        if (entry["action"] == "dropped" && entry["defect"] != "pointsAndLines")
            count += entry["count"].get<std::uint64_t>();
    const nlohmann::json& leftOut = report["leftOut"];
    return leftOut.contains("invisibleTriangles")
               ? count + leftOut["invisibleTriangles"]["count"].get<std::uint64_t>()
               : count;
}

// The largest take minutes in all: they are read where RT_SLOW_TESTS is set.
TEST(ImportCollection, EveryModelHasItsTrianglesOrTheLedgerSaysWhereTheyWent) {
    constexpr int kMostTriangles = 200'000;
    const std::vector<Row> rows = readTable(test::scenePath("MANIFEST.tsv"));
    if (rows.empty()) GTEST_SKIP() << "the scene collection is absent";
    for (Row row : rows) {
        SCOPED_TRACE(row["file"]);
        const int triangles = std::stoi(row["instanced_triangles"]);
        if (triangles > kMostTriangles && !std::getenv("RT_SLOW_TESTS")) continue;
        const test::TemporaryFolder folder;
        const CommandResult result = importFile(test::scenePath(row["file"]), folder);
        ASSERT_EQ(result.exitCode, 0) << result.err;
        const nlohmann::json report = nlohmann::json::parse(test::readText(folder.file("out.json")));
        EXPECT_EQ(report["triangles"].get<std::uint64_t>() + droppedTriangles(report), triangles)
            << result.err;
        EXPECT_GT(report["triangles"].get<double>(), 0.5 * triangles);
        EXPECT_LT(result.peakMemoryBytes, std::uint64_t(3) << 29); // 1.5 GiB
    }
}

// broken_outcomes.tsv says how each ends; files that it does not know are a fault too.
TEST(ImportCollection, EveryBrokenFileEndsAsItsRowSays) {
#ifdef __SANITIZE_ADDRESS__
    GTEST_SKIP() << "the sanitizer takes the signals of crashes";
#endif
    const std::vector<Row> rows = readTable(test::scenePath("BROKEN.tsv"));
    if (rows.empty()) GTEST_SKIP() << "the scene collection is absent";
    std::map<std::string, Row> outcomes;
    for (Row row : readTable(RT_SOURCE_DIR "/tests/cli/broken_outcomes.tsv")) outcomes[row["file"]] = row;
    ASSERT_EQ(outcomes.size(), rows.size());
    for (Row row : rows) {
        SCOPED_TRACE(row["file"]);
        Row outcome = outcomes[row["file"]];
        const test::TemporaryFolder folder;
        const CommandResult result = importFile(test::scenePath(row["file"]), folder);
        EXPECT_EQ(std::to_string(result.exitCode), outcome["exit"]) << result.err;
        EXPECT_THAT(result.err, testing::HasSubstr(outcome["says"]));
        EXPECT_LT(result.seconds, 20.0);
        EXPECT_LT(result.peakMemoryBytes, std::uint64_t(2) << 30);
        EXPECT_EQ(folder.entryCount(), result.exitCode == 0 ? 2u : 0u);
        if (result.exitCode != 0) {
            EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
            continue;
        }
        const std::string mesh = test::readText(folder.file("out.rtmesh"));
        importFile(test::scenePath(row["file"]),
                   folder); // what a loader reads past the end differs between runs
        EXPECT_TRUE(mesh == test::readText(folder.file("out.rtmesh")));
    }
}

} // namespace
} // namespace rt

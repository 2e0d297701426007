#pragma once
#include "formats/mesh_file.h"
#include "tests/support/make_mesh.h"
#include "tests/support/read_text.h"
#include "tests/support/run_command.h"
#include "tests/support/temporary_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <memory>

namespace rt::test {

inline void spit(const std::string& path, const std::string& bytes) {
    std::ofstream(path, std::ios::binary) << bytes;
}

/// rt-trace on a sphere of 1280 triangles.
class TraceCommand : public testing::Test {
protected:
    static void SetUpTestSuite() {
        folder = std::make_unique<TemporaryFolder>();
        writeMesh(folder->file("s.rtmesh"), makeSphere(3));
        const CommandResult grid = runCommand({RT_BIN_DIR "/rt-grid", folder->file("s.rtmesh"), "-o",
                                               folder->file("s.rtatlas"), "--structure", "cloud"});
        ASSERT_EQ(grid.exitCode, 0) << grid.err;
    }
    static void TearDownTestSuite() { folder.reset(); }

    CommandResult trace(std::vector<std::string> arguments) const {
        arguments.insert(arguments.begin(), RT_BIN_DIR "/rt-trace");
        return runCommand(arguments);
    }
    std::string atlas() const { return folder->file("s.rtatlas"); }

    // One line on standard error, that code, and no output.
    void expectFailure(std::vector<std::string> arguments, int exitCode, const std::string& message) {
        const std::string output = out.file("out.exr");
        std::replace(arguments.begin(), arguments.end(), std::string("OUT"), output);
        const CommandResult result = trace(arguments);
        EXPECT_EQ(result.exitCode, exitCode) << result.err;
        EXPECT_THAT(result.err, testing::HasSubstr(message));
        EXPECT_THAT(result.err, testing::HasSubstr("rt-trace: error: "));
        EXPECT_EQ(out.entryCount(), 0u) << "something was left behind";
    }

    inline static std::unique_ptr<TemporaryFolder> folder;
    TemporaryFolder out;
};

} // namespace rt::test

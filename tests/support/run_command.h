#pragma once
#include <string>
#include <vector>

namespace rt::test {

struct CommandResult {
    int exitCode; ///< 128 + signal if it was killed by one
    std::string out;
    std::string err;
};

/// Runs a program (no shell) to its end. argv[0] is a path; the tools are in RT_BIN_DIR.
CommandResult runCommand(const std::vector<std::string>& argv, const std::string& input = "");

} // namespace rt::test

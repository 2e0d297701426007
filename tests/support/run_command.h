#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace rt::test {

struct CommandResult {
    int exitCode; ///< 128 + signal if it was killed by one
    std::string out;
    std::string err;
    double seconds = 0.0;
    double processorSeconds = 0.0;     ///< of all its threads
    std::uint64_t peakMemoryBytes = 0; ///< the largest of the program and its children
};

/// Runs a program (no shell) to its end. argv[0] is a path; the tools are in RT_BIN_DIR.
CommandResult runCommand(const std::vector<std::string>& argv, const std::string& input = "");

} // namespace rt::test

#pragma once

namespace rt {

/// Runs a tool's body with the only catch block of the program: an Error becomes one line on standard error
/// and its exit code; any other exception becomes exit code 70; running out of memory becomes 5.
int runTool(const char* name, int argc, char** argv, int (*body)(int argc, const char* const* argv));

} // namespace rt

#pragma once

namespace rt {

/// Runs a tool's body with the only catch blocks that turn errors into exit codes: an Error becomes one line
/// on standard error and its exit code; any other exception becomes exit code 70; running out of memory
/// becomes 5. An input that shrinks while it is mapped becomes 3. SIGINT, SIGTERM and SIGHUP end the tool as
/// they always do, but remove an output that is half written.
int runTool(const char* name, int argc, char** argv, int (*body)(int argc, const char* const* argv));

} // namespace rt

#include "common/run_tool.h"
#include "tools/rt-grid/build_command.h"
#include "tools/rt-grid/inspect_command.h"
#include "tools/rt-grid/verify_command.h"

#include <string_view>

namespace rt {
namespace {

int gridMain(int argc, const char* const* argv) {
    const std::string_view command = argc > 1 ? argv[1] : "";
    if (command == "inspect") return inspectCommand(argc - 1, argv + 1);
    if (command == "verify") return verifyCommand(argc - 1, argv + 1);
    return buildCommand(argc, argv);
}

} // namespace
} // namespace rt

int main(int argc, char** argv) {
    return rt::runTool("rt-grid", argc, argv, rt::gridMain);
}

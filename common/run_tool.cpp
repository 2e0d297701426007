#include "common/run_tool.h"

#include "common/error.h"
#include "common/log.h"

#include <csignal>
#include <exception>
#include <new>
#include <string>

namespace rt {
namespace {

// A message is one line whatever file names or libraries put into it.
std::string oneLine(std::string text) {
    for (char& c : text)
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
    return text;
}

} // namespace

int runTool(const char* name, int argc, char** argv, int (*body)(int argc, const char* const* argv)) {
    setToolName(name);
    std::signal(SIGPIPE, SIG_IGN); // a closed pipe is a write error with a message, not a silent death
    try {
        return body(argc, argv);
    } catch (const Error& error) {
        logError(oneLine(error.what()));
        return static_cast<int>(error.kind());
    } catch (const std::bad_alloc&) {
        logError("out of memory; use a smaller scene, a lower --resolution or a machine with more memory");
        return static_cast<int>(ErrorKind::LimitExceeded);
    } catch (const std::exception& error) {
        logError("internal error: " + oneLine(error.what()));
        return static_cast<int>(ErrorKind::Internal);
    }
}

} // namespace rt

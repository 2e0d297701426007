#include "common/run_tool.h"

#include "common/binary_io.h"
#include "common/error.h"
#include "common/log.h"

#include <csignal>
#include <exception>
#include <new>
#include <string>
#include <unistd.h>

namespace rt {
namespace {

// A message is one line whatever file names or libraries put into it.
std::string oneLine(std::string text) {
    for (char& c : text)
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
    return text;
}

char inputChangedLine[128]; // made beforehand: a signal handler may not format
std::size_t inputChangedLength = 0;

// SIGBUS for an address inside a mapping: the file has become shorter than what was mapped.
void onBusError(int, siginfo_t* info, void*) {
    if (info->si_code != BUS_ADRERR) return; // something else; it comes back at once and ends the program
    removeUnfinishedFiles();
    [[maybe_unused]] const ssize_t put = write(STDERR_FILENO, inputChangedLine, inputChangedLength);
    _exit(static_cast<int>(ErrorKind::FileAccess));
}

void onStop(int signal) {
    removeUnfinishedFiles();
    raise(signal); // by default now, once this handler has returned
}

void handleSignals(const char* name) {
    std::signal(SIGPIPE, SIG_IGN); // a closed pipe is a write error with a message, not a silent death
    std::string line = std::string(name) + ": error: an input file changed while it was read\n";
    inputChangedLength = line.copy(inputChangedLine, sizeof inputChangedLine);
    struct sigaction action {};
    action.sa_flags = static_cast<int>(SA_SIGINFO | SA_RESETHAND);
    action.sa_sigaction = onBusError;
    sigaction(SIGBUS, &action, nullptr);
    action.sa_flags = static_cast<int>(SA_RESETHAND);
    action.sa_handler = onStop;
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
        struct sigaction before {};
        sigaction(signal, nullptr, &before);
        if (before.sa_handler != SIG_IGN) sigaction(signal, &action, nullptr); // nohup keeps its word
    }
}

} // namespace

int runTool(const char* name, int argc, char** argv, int (*body)(int argc, const char* const* argv)) {
    setToolName(name);
    handleSignals(name);
    try {
        return body(argc, argv);
    } catch (const Error& error) {
        logError(oneLine(error.what()));
        return static_cast<int>(error.kind());
    } catch (const std::bad_alloc&) {
        logError(
            "out of memory; use smaller inputs, a higher limit on memory (--max-memory, where the tool has "
            "it) or a machine with more memory");
        return static_cast<int>(ErrorKind::LimitExceeded);
    } catch (const std::exception& error) {
        logError("internal error: " + oneLine(error.what()));
        return static_cast<int>(ErrorKind::Internal);
    }
}

} // namespace rt

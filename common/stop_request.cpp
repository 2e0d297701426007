#include "common/stop_request.h"

#include <array>
#include <csignal>
#include <cstdlib>

namespace rt {
namespace {

constexpr std::array<int, 3> kSignals = {SIGINT, SIGTERM, SIGHUP};
volatile std::sig_atomic_t noted = 0;
std::array<struct sigaction, kSignals.size()> before{};

void note(int signal) {
    noted = signal;
}

} // namespace

StopRequest::StopRequest() {
    noted = 0;
    struct sigaction action {};
    action.sa_flags = static_cast<int>(SA_RESETHAND);
    action.sa_handler = note;
    for (std::size_t i = 0; i < kSignals.size(); ++i) {
        sigaction(kSignals[i], nullptr, &before[i]);
        if (before[i].sa_handler != SIG_IGN) sigaction(kSignals[i], &action, nullptr); // nohup keeps its word
    }
}

StopRequest::~StopRequest() {
    for (std::size_t i = 0; i < kSignals.size(); ++i) sigaction(kSignals[i], &before[i], nullptr);
}

bool StopRequest::made() const {
    return noted != 0;
}

void StopRequest::obey() const {
    std::signal(noted, SIG_DFL);
    std::raise(noted);
    std::abort(); // the signal is blocked
}

} // namespace rt

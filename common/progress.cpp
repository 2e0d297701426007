#include "common/progress.h"

#include "common/log.h"
#include "common/stage_timer.h"

#include <fmt/format.h>

#include <cmath>
#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <thread>
#include <unistd.h>

namespace rt {
namespace {

using namespace std::chrono_literals;

constexpr auto kQuietStart = 1s;
constexpr auto kInterval = 200ms;

// What cannot take colours cannot take a line that is drawn again and again either.
bool onTerminal() {
    const char* const noColor = std::getenv("NO_COLOR");
    const char* const terminal = std::getenv("TERM");
    return isatty(STDERR_FILENO) && !(noColor && *noColor) &&
           !(terminal && std::string(terminal) == "dumb") && logLevel() >= LogLevel::Normal;
}

std::string rateText(const std::string& unit, double rate) {
    if (rate >= 1e9) return fmt::format("{:.1f} G {}/s", rate * 1e-9, unit);
    if (rate >= 1e6) return fmt::format("{:.1f} M {}/s", rate * 1e-6, unit);
    if (rate >= 1e3) return fmt::format("{:.1f} k {}/s", rate * 1e-3, unit);
    return fmt::format("{:.1f} {}/s", rate, unit);
}

} // namespace

std::string durationText(double seconds) {
    if (seconds < 1.0) return fmt::format("{:.0f} ms", seconds * 1e3);
    const auto whole = static_cast<long long>(std::llround(seconds));
    if (whole < 60) return fmt::format("{} s", whole);
    if (whole < 3600) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
    return fmt::format("{} h {:02} min", whole / 3600, whole % 3600 / 60);
}

std::string progressText(const std::string& unit, double done, double total, double rate) {
    std::string text = fmt::format("{:.0f} %", total > 0.0 ? std::floor(100.0 * done / total) : 100.0);
    if (!(rate > 0.0)) return text;
    const std::string left = durationText((total - done) / rate);
    return text + (unit.empty() ? fmt::format(", {} left", left)
                                : fmt::format(", {}, {} left", rateText(unit, rate), left));
}

Progress::Progress(std::string unit, double total, double done)
    : unit_(std::move(unit)), total_(total), first_(done), start_(Clock::now()),
      last_(start_ + kQuietStart - kInterval), visible_(onTerminal()) {}

Progress::~Progress() {
    clear();
}

void Progress::update(double done) {
    const Clock::time_point now = Clock::now();
    if (!visible_ || now < last_ + kInterval) return;
    last_ = now;
    drawn_ = true;
    const double rate = (done - first_) / std::chrono::duration<double>(now - start_).count();
    std::fprintf(stderr, "\r\033[K%s", progressText(unit_, done, total_, rate).c_str());
    std::fflush(stderr);
}

void Progress::clear() {
    if (drawn_) std::fputs("\r\033[K", stderr);
    drawn_ = false;
}

class StageProgress::Thread {
public:
    explicit Thread(const StageTimer& timer) : timer_(timer), thread_([this] { run(); }) {}
    ~Thread() {
        {
            const std::scoped_lock lock(mutex_);
            isOver_ = true;
        }
        wake_.notify_one();
        thread_.join();
    }

private:
    void run() {
        std::unique_lock lock(mutex_);
        for (auto interval = std::chrono::milliseconds(kQuietStart);
             !wake_.wait_for(lock, interval, [this] { return isOver_; }); interval = kInterval)
            std::fprintf(stderr, "\r\033[K%s", timer_.runningText().c_str());
        std::fputs("\r\033[K", stderr);
    }

    const StageTimer& timer_;
    std::mutex mutex_; // of isOver_
    std::condition_variable wake_;
    bool isOver_ = false;
    std::thread thread_; // last: it uses the others
};

StageProgress::StageProgress(const StageTimer& timer)
    : thread_(onTerminal() ? std::make_unique<Thread>(timer) : nullptr) {}

StageProgress::~StageProgress() = default;

} // namespace rt

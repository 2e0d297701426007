#include "tools/rt-trace/render_loop.h"

#include "common/progress.h"
#include "common/stage_timer.h"
#include "common/stop_request.h"
#include "tools/rt-trace/gpu_timer.h"
#include "tools/rt-trace/shader_variant.h"

#include <epoxy/gl.h>
#include <glm/common.hpp>

#include <algorithm>
#include <cmath>

namespace rt {
namespace {

constexpr double kDispatchMs = 150.0;       // aimed at; none should take 250: displays freeze, Ctrl-C waits
constexpr double kMostGrowth = 4.0;         // from one dispatch to the next: costs differ over a picture
constexpr double kFirstSoftware = 1u << 14; // samples of the first dispatch
constexpr double kFirstHardware = 1u << 22;
constexpr double kSaveMs = 30e3;
// The error is looked at each time that tiles have this many samples more, whatever the cuts.
constexpr std::uint32_t kErrorSamples = 16;
constexpr double kDarkest = 0.01;

/// How many samples, of all pixels together, a dispatch should have.
class Pace {
public:
    Pace(bool software, std::uint64_t most)
        : most_(static_cast<double>(most)),
          samples_(std::min(software ? kFirstSoftware : kFirstHardware, most_)) {}
    std::uint64_t samples() const { return static_cast<std::uint64_t>(samples_); }
    void learn(double dispatched, double elapsedMs) {
        const double wanted = dispatched * kDispatchMs / std::max(elapsedMs, 1e-3);
        samples_ = std::clamp(std::min(wanted, std::max(samples_, dispatched) * kMostGrowth), 1.0, most_);
    }

private:
    double most_;
    double samples_;
};

double samplesOf(const TileSamples& tiles, bool goals) {
    double sum = 0.0;
    for (std::size_t i = 0; i < tiles.tiles().size(); ++i) {
        const TileSamples::Region region{tiles.pixelsOf(i), 0};
        const TileSamples::Tile& tile = tiles.tiles()[i];
        sum += double(region.pixelCount()) * (goals ? tile.goal : tile.samples);
    }
    return sum;
}

class Loop {
public:
    Loop(const GpuPrograms& programs, GpuView& view, const Film& film, const GlContext& context,
         TileSamples& tiles, const LoopControl& control)
        : programs_(programs), view_(view), film_(film), software_(context.device().software), tiles_(tiles),
          control_(control), pace_(software_, control.mostSamples),
          progress_("samples", samplesOf(tiles, true), samplesOf(tiles, false)),
          done_(samplesOf(tiles, false)), savedMs_(programMs()) {}

    LoopFigures run() {
        while (const auto round = tiles_.nextRound()) {
            if (control_.targetError > 0.0 && round->samples > 0 && round->samples % kErrorSamples == 0 &&
                stopGoodTiles(round->samples))
                continue;
            if (!runRound(*round)) break;
        }
        return figures_;
    }

private:
    // False if the time is over.
    bool runRound(const TileSamples::Round& round) {
        std::uint32_t count = round.most;
        if (control_.targetError > 0.0)
            count = std::min(count, kErrorSamples - round.samples % kErrorSamples);
        const std::uint64_t affordable =
            pace_.samples() / std::max<std::uint64_t>(tiles_.unfinishedPixels(), 1);
        count = static_cast<std::uint32_t>(std::clamp<std::uint64_t>(affordable, 1, count));
        while (const auto region = tiles_.next(round.samples, pace_.samples() / count)) {
            if (control_.endMs > 0.0 && round.samples > 0 && programMs() >= control_.endMs) {
                figures_.timeLimitReached = true;
                return false;
            }
            dispatch(*region, count);
            afterDispatch();
        }
        return true;
    }

    void dispatch(const TileSamples::Region& region, std::uint32_t count) {
        GpuTimer timer(software_);
        timer.begin();
        view_.render(programs_, region.pixels, region.samples, count);
        timer.end();
        const double elapsedMs = timer.elapsedMs();
        checkGl("rendering");
        const double dispatched = double(region.pixelCount()) * count;
        tiles_.add(region, count);
        pace_.learn(dispatched, elapsedMs);
        done_ += dispatched;
        figures_.gpuMs += elapsedMs;
        figures_.samples += region.pixelCount() * count;
        ++figures_.dispatches;
    }

    void afterDispatch() {
        progress_.update(done_);
        const bool due = programMs() - savedMs_ > kSaveMs;
        if (control_.save && (due || stop_.made())) {
            control_.save(figures_.gpuMs);
            savedMs_ = programMs();
        }
        if (!stop_.made()) return;
        progress_.clear();
        stop_.obey();
    }

    // Whether there were any.
    bool stopGoodTiles(std::uint32_t samples) {
        const glm::uvec4 window = tiles_.window();
        const unsigned width = window.z - window.x;
        const std::vector<glm::vec2> moments = film_.readMoments(window);
        std::size_t stopped = 0;
        for (std::size_t i = 0; i < tiles_.tiles().size(); ++i) {
            TileSamples::Tile& tile = tiles_.tiles()[i];
            if (tile.finished() || tile.samples != samples) continue;
            const glm::uvec4 pixels = tiles_.pixelsOf(i);
            std::vector<glm::vec2> ofTile;
            for (unsigned y = pixels.y; y < pixels.w; ++y)
                for (unsigned x = pixels.x; x < pixels.z; ++x)
                    ofTile.push_back(moments[std::size_t(y - window.y) * width + (x - window.x)]);
            if (!(meanRelativeError(ofTile, samples) <= control_.targetError)) continue; // NaN too
            tile.goal = samples;
            ++stopped;
        }
        figures_.tilesStopped += stopped;
        return stopped > 0;
    }

    const GpuPrograms& programs_;
    GpuView& view_;
    const Film& film_;
    bool software_;
    TileSamples& tiles_;
    const LoopControl& control_;
    Pace pace_;
    Progress progress_;
    StopRequest stop_;
    double done_; // samples of all pixels
    double savedMs_;
    LoopFigures figures_;
};

} // namespace

double meanRelativeError(std::span<const glm::vec2> moments, std::uint32_t samples) {
    if (moments.empty()) return 0.0;
    double sum = 0.0;
    for (const glm::vec2& m : moments)
        sum += std::sqrt(varianceOfMean(m, samples)) / std::max(double(m.y) / samples, kDarkest);
    return sum / static_cast<double>(moments.size());
}

LoopFigures renderTiles(const GpuPrograms& programs, GpuView& view, const Film& film,
                        const GlContext& context, TileSamples& tiles, const LoopControl& control) {
    return Loop(programs, view, film, context, tiles, control).run();
}

} // namespace rt

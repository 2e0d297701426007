#include "tests/stress/stress_fixture.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <optional>
#include <span>
#include <vector>

namespace rt::test {
namespace {

using Range = tbb::blocked_range<std::size_t>;

constexpr std::size_t kBatch = 1u << 21; // 64 MiB of rays
constexpr std::uint64_t kSeed = 7;
constexpr std::uint64_t kEnoughForARate = 1'000'000;
constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

/// How many indices `holds` is true for, and the lowest of them.
struct Found {
    std::uint64_t count = 0;
    std::size_t first = kNone;
};
template <class Holds>
Found findAll(std::size_t count, Holds holds) {
    const auto addRange = [&](const Range& range, Found found) {
        for (std::size_t i = range.begin(); i < range.end(); ++i)
            if (holds(i)) found = {found.count + 1, std::min(found.first, i)};
        return found;
    };
    return tbb::parallel_reduce(Range(0, count, 4096), Found{}, addRange, [](const Found& a, const Found& b) {
        return Found{a.count + b.count, std::min(a.first, b.first)};
    });
}

std::string textOf(const QueryRay& ray, const QueryHit& hit, const QueryHitDouble* reference) {
    const glm::vec4& o = ray.originTmin;
    const glm::vec4& d = ray.directionTmax;
    std::string text =
        fmt::format("origin ({:a}, {:a}, {:a}), direction ({:a}, {:a}, {:a}), t in [{:a}, {:a}]: "
                    "t {}, triangle {}",
                    o.x, o.y, o.z, d.x, d.y, d.z, o.w, d.w, distanceOf(hit), int(hit.tuvId.w));
    if (reference)
        text += fmt::format("; in double t {}, triangle {}", reference->t, int(reference->triangle));
    return text;
}

} // namespace

std::uint64_t raysPerCase() {
    const char* const text = std::getenv("RT_STRESS_RAYS");
    return text ? std::strtoull(text, nullptr, 10) : 60'000;
}

/// One case on its way through the device.
class Stress::Run {
public:
    Run(const StressCase& stress, std::uint64_t rayCount)
        : stress_(stress), rayCount_(rayCount), rays_(std::min<std::uint64_t>(kBatch, rayCount)),
          hits_(rays_.size()) {
        if (stress.hasReference) {
            references_.resize(rays_.size());
            reference_.emplace(*context, stress.atlas, QuerySettings{}, false, rays_.size(), programs());
        }
    }

    /// Calls trace(rays, hits, isFirst) for each batch, and judges the hits.
    template <class Trace>
    Tally judge(Trace trace) {
        Tally tally;
        for (std::uint64_t done = 0; done < rayCount_; done += rays_.size()) {
            const auto count = std::min<std::uint64_t>(rays_.size(), rayCount_ - done);
            const std::span rays(rays_.data(), count);
            tbb::parallel_for(Range(0, count, 4096), [&](const Range& range) {
                for (std::size_t i = range.begin(); i < range.end(); ++i) {
                    RayNumbers numbers(kSeed, done + i);
                    rays[i] = stress_.makeRay(numbers);
                }
            });
            trace(rays, std::span(hits_.data(), count), done == 0);
            if (reference_) reference_->trace(rays, std::span(references_.data(), count));
            add(tally, count);
        }
        return tally;
    }

    std::size_t batchSize() const { return rays_.size(); }

private:
    const QueryHitDouble* referenceOf(std::size_t i) const {
        return references_.empty() ? nullptr : &references_[i];
    }
    void add(Tally& tally, std::size_t count) const {
        const Found wrong = findAll(
            count, [&](std::size_t i) { return stress_.isWrong(rays_[i], hits_[i], referenceOf(i)); });
        if (tally.wrong == 0 && wrong.count > 0)
            tally.firstWrong = textOf(rays_[wrong.first], hits_[wrong.first], referenceOf(wrong.first));
        tally.rays += count;
        tally.wrong += wrong.count;
    }

    const StressCase& stress_;
    std::uint64_t rayCount_;
    std::vector<QueryRay> rays_;
    std::vector<QueryHit> hits_;
    std::vector<QueryHitDouble> references_;
    std::optional<BatchTracer<QueryHitDouble>> reference_;
};

ProgramCache& Stress::programs() {
    if (!programs_) programs_ = std::make_unique<ProgramCache>();
    return *programs_;
}

Tally Stress::watertight(const StressCase& stress) {
    Run run(stress, std::max<std::uint64_t>(raysPerCase() * stress.times / stress.part, 1));
    BatchTracer<QueryHit> plain(*context, stress.atlas, {}, false, run.batchSize(), programs());
    BatchTracer<QueryHit> scattered(*context, stress.atlas, {}, true, run.batchSize(), programs());
    std::vector<QueryHit> others(run.batchSize());
    return run.judge([&](std::span<const QueryRay> rays, std::span<QueryHit> hits, bool isFirst) {
        plain.trace(rays, hits);
        if (isFirst) scattered.traceBackwards(rays); // later on the batch before leaves other hits
        scattered.trace(rays, std::span(others).first(rays.size()));
        const Found different =
            findAll(rays.size(), [&](std::size_t i) { return hits[i].tuvId != others[i].tuvId; });
        EXPECT_EQ(different.count, 0u)
            << stress.name << ": other hits where rays are traced as scattered ones: "
            << textOf(rays[different.first], hits[different.first], nullptr);
    });
}

Tally Stress::measured(const StressCase& stress, unsigned intersect) {
    Run run(stress, std::max<std::uint64_t>(std::min(kEnoughForARate, raysPerCase()) / stress.part, 1));
    BatchTracer<QueryHit> plain(*context, stress.atlas, {.limits = {}, .intersect = intersect}, false,
                                run.batchSize(), programs());
    return run.judge(
        [&](std::span<const QueryRay> rays, std::span<QueryHit> hits, bool) { plain.trace(rays, hits); });
}

void Stress::report(const StressCase& stress, const char* test, const Tally& tally) {
    fmt::print("{}, {}: {} of {} rays {}\n", stress.name, test, tally.wrong, tally.rays, stress.fault);
}

void Stress::expectNoneWrong(const StressCase& stress) {
    const Tally tally = watertight(stress);
    report(stress, "watertight", tally);
    EXPECT_EQ(tally.wrong, 0u) << stress.name << ": " << tally.firstWrong;
    report(stress, "moller-trumbore", measured(stress, kIntersectMollerTrumbore));
    report(stress, "baldwin-weber", measured(stress, kIntersectBaldwinWeber));
}

} // namespace rt::test

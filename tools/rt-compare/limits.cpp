#include "tools/rt-compare/limits.h"

#include "common/command_line.h"
#include "common/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace rt {
namespace {

bool suits(Metric metric, LayerKind kind) {
    const MetricOf of = traitsOf(metric).of;
    return of == MetricOf::All ||
           (of == MetricOf::Colors ? kind == LayerKind::Color : kind != LayerKind::Ids);
}

bool isOpacity(const LayerComparison& layer, const ChannelComparison& channel) {
    return layer.kind == LayerKind::Color && channel.name.ends_with("A");
}

double overOf(const ErrorFigures& figures, double threshold) {
    for (const OverThreshold& over : figures.over)
        if (over.threshold == threshold) return over.fraction;
    return kNotComputed;
}

// Less than one value, unless it is the only one, is none that a limit could hold.
double percentileOf(const ErrorFigures& figures, double percent) {
    if (figures.compared > 1 && percent * static_cast<double>(figures.compared) < 100.0) return kNotComputed;
    for (const Percentile& percentile : figures.percentiles)
        if (percentile.percent == percent) return percentile.absError;
    return kNotComputed;
}

double valueOf(const Limit& limit, const ErrorFigures& figures) {
    if (limit.metric == Metric::Percentile) return percentileOf(figures, limit.parameter);
    if (limit.metric == Metric::Over || limit.metric == Metric::Differing)
        return overOf(figures, limit.parameter);
    const auto figure = traitsOf(limit.metric).figure;
    return figure ? figures.*figure : kNotComputed;
}

double valueOf(const Limit& limit, const LayerComparison& layer) {
    if (limit.metric == Metric::Flip) return layer.flip ? layer.flip->mean : kNotComputed;
    if (limit.metric == Metric::Ssim) return layer.ssim.value_or(kNotComputed);
    if (limit.metric == Metric::MsSsim) return layer.msSsim.value_or(kNotComputed);
    return valueOf(limit, layer.figures);
}

class LimitChecker {
public:
    LimitChecker(const std::vector<Limit>& limits, bool tolerant, Comparison& comparison)
        : limits_(limits), tolerant_(tolerant), comparison_(comparison) {}

    void run() {
        const bool someUnnamed =
            std::ranges::any_of(limits_, [](const Limit& limit) { return limit.where.empty(); });
        for (const LayerComparison& layer : comparison_.layers) {
            const std::vector<const Limit*> limits = limitsOf(layer);
            for (const Limit* limit : limits) check(*limit, layer.name, valueOf(*limit, layer));
            const std::set<std::string> held = checkChannels(layer);
            const bool isAlike = tolerant_ || (layer.kind == LayerKind::Data && someUnnamed);
            if (isAlike && layer.kind != LayerKind::Ids) continue;
            if (limits.empty() && held.empty())
                checkEqual(layer);
            else
                checkOthersEqual(layer, limits, held);
        }
        requireKnownNames();
        requireSuitableNames();
    }

private:
    // 3: names the layer; 2: all; 1: all colours; 0: another one.
    static int precisionOf(const Limit& limit, const LayerComparison& layer) {
        if (!suits(limit.metric, layer.kind)) return 0;
        if (limit.where.empty()) return layer.kind == LayerKind::Color ? 1 : 0;
        if (limit.where == "*") return 2;
        return isNamed(layer.name, limit.where) ? 3 : 0;
    }

    static bool isStricter(const Limit& limit, const Limit& other) {
        return traitsOf(limit.metric).isAtLeast ? limit.value > other.value : limit.value < other.value;
    }

    // For each kind of figure the limit with the most precise name, and of several such the strictest.
    std::vector<const Limit*> limitsOf(const LayerComparison& layer) const {
        std::vector<const Limit*> chosen;
        for (const Limit& limit : limits_) {
            const int precision = precisionOf(limit, layer);
            if (precision == 0) continue;
            const auto same = std::ranges::find_if(chosen, [&](const Limit* other) {
                return other->metric == limit.metric && other->parameter == limit.parameter;
            });
            if (same == chosen.end()) {
                chosen.push_back(&limit);
                continue;
            }
            const int other = precisionOf(**same, layer);
            if (precision > other || (precision == other && isStricter(limit, **same))) *same = &limit;
        }
        return chosen;
    }

    // Limits that name one channel of a layer of several. Returns those channels.
    std::set<std::string> checkChannels(const LayerComparison& layer) {
        std::set<std::string> held;
        for (const ChannelComparison& channel : layer.channels) {
            if (channel.name == layer.name) continue;
            for (const Limit& limit : limits_) {
                if (limit.where.empty() || !isNamed(channel.name, limit.where)) continue;
                check(limit, channel.name, valueOf(limit, channel.figures));
                held.insert(channel.name);
            }
        }
        return held;
    }

    // Channels that none of a layer's limits looks at: all but those with limits of their own, or, beside
    // limits on what is seen, the opacity.
    void checkOthersEqual(const LayerComparison& layer, const std::vector<const Limit*>& limits,
                          const std::set<std::string>& held) {
        const bool isSeenOnly = std::ranges::all_of(
            limits, [](const Limit* limit) { return traitsOf(limit->metric).of == MetricOf::Colors; });
        for (const ChannelComparison& channel : layer.channels) {
            const bool isFree = limits.empty() || (isSeenOnly && isOpacity(layer, channel));
            const Limit equal{Metric::Rmse, channel.name, 0.0, 0.0};
            if (isFree && !held.contains(channel.name))
                check(equal, channel.name, valueOf(equal, channel.figures));
        }
    }

    void checkEqual(const LayerComparison& layer) {
        const Metric metric = layer.kind == LayerKind::Ids ? Metric::Differing : Metric::Rmse;
        const Limit equal{metric, layer.name, 0.0, 0.0};
        check(equal, layer.name, valueOf(equal, layer));
    }

    void check(const Limit& limit, const std::string& where, double value) {
        const bool atLeast = traitsOf(limit.metric).isAtLeast;
        const bool passed = atLeast ? value >= limit.value : value <= limit.value; // false for NaN
        comparison_.checks.push_back({limit, where, value, passed});
        if (passed) return;
        const char* fault = std::isnan(value) ? "could not be computed; limit"
                            : atLeast         ? "is below"
                                              : "exceeds";
        const std::string found = std::isnan(value) ? "" : fmt::format(" {:.9g}", value);
        comparison_.findings.push_back(
            {FindingKind::Limit,
             fmt::format("{}: {}{} {} {:.9g}", where, metricName(limit), found, fault, limit.value)});
    }

    void requireKnownNames() {
        std::set<std::string> names;
        for (const LayerComparison& layer : comparison_.layers) {
            names.insert(layer.name);
            for (const ChannelComparison& channel : layer.channels) names.insert(channel.name);
        }
        for (const Limit& limit : limits_) {
            if (limit.where.empty() || limit.where == "*") continue;
            if (std::ranges::any_of(names,
                                    [&](const std::string& name) { return isNamed(name, limit.where); }))
                continue;
            comparison_.findings.push_back(
                {FindingKind::Limit,
                 fmt::format(
                     "no layer or channel is called {}, for which a limit of {} is given; there are: {}",
                     limit.where, metricName(limit), fmt::join(names, ", "))});
        }
    }

    // A limit on a layer that has no such figure would hold nothing, and nobody would know.
    void requireSuitableNames() {
        for (const Limit& limit : limits_) {
            if (limit.where.empty() || limit.where == "*") continue;
            for (const LayerComparison& layer : comparison_.layers) {
                if (!isNamed(layer.name, limit.where) || suits(limit.metric, layer.kind)) continue;
                const char* remedy = layer.kind == LayerKind::Ids ? "of uint channels; --max-differing"
                                                                  : "of layers without colors; --max-rmse";
                comparison_.findings.push_back(
                    {FindingKind::Limit, fmt::format("{}: there is no {} {} {}=X holds it", layer.name,
                                                     metricName(limit), remedy, limit.where)});
            }
        }
    }

    const std::vector<Limit>& limits_;
    bool tolerant_;
    Comparison& comparison_;
};

} // namespace

Limit parseLimit(Metric metric, const std::string& text) {
    const MetricTraits& traits = traitsOf(metric);
    const std::string option = traits.option;
    Limit limit{metric, {}, 0.0, 0.0};
    std::string numbers = text;
    if (const std::size_t equals = text.rfind('='); equals != text.npos) {
        limit.where = text.substr(0, equals);
        numbers = text.substr(equals + 1);
        if (limit.where.empty())
            throw Error(ErrorKind::Usage, fmt::format("{}: '{}' names nothing", option, text));
    }
    if (traits.hasParameter) {
        const std::size_t colon = numbers.find(':');
        if (colon == numbers.npos)
            throw Error(ErrorKind::Usage,
                        fmt::format("{}: '{}' is not two numbers with a colon between them", option, text));
        limit.parameter = parseNumbers(numbers.substr(0, colon), 1, option).front();
        numbers.erase(0, colon + 1);
    }
    limit.value = parseNumbers(numbers, 1, option).front();
    const double highest = traits.isFraction ? 1.0 : std::numeric_limits<double>::max();
    if (metric != Metric::Psnr && (limit.value < 0.0 || limit.value > highest))
        throw Error(ErrorKind::Usage, fmt::format("{}: {} is not a finite number >= 0{}", option, limit.value,
                                                  highest == 1.0 ? " and <= 1" : ""));
    if (limit.parameter < 0.0 ||
        (metric == Metric::Percentile && (limit.parameter <= 0.0 || limit.parameter > 100.0)))
        throw Error(ErrorKind::Usage,
                    fmt::format("{}: {} is no {}", option, limit.parameter,
                                metric == Metric::Over ? "threshold" : "percentage above 0"));
    return limit;
}

std::string metricName(const Limit& limit) {
    return fmt::format(fmt::runtime(traitsOf(limit.metric).name), limit.parameter);
}

bool isNamed(const std::string& name, const std::string& where) {
    return name == where || (name.size() > where.size() && name.ends_with(where) &&
                             name[name.size() - where.size() - 1] == '/');
}

void checkLimits(const std::vector<Limit>& limits, bool tolerant, Comparison& comparison) {
    LimitChecker(limits, tolerant, comparison).run();
}

} // namespace rt

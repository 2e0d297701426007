#include "tools/rt-compare/self_test.h"

#include "common/binary_io.h"
#include "common/error.h"
#include "common/json_file.h"
#include "tools/rt-compare/layers.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

namespace rt {
namespace {

/// The channels that faults are put into: the first layer of colors, else of numbers; without A.
std::vector<std::size_t> targetChannels(const Image& image) {
    std::vector<std::size_t> indices;
    for (const LayerPair& layer : pairLayers(image, image, 0, "")) {
        if (layer.kind == LayerKind::Ids) continue;
        for (const ChannelPair& channel : layer.channels)
            if (channel.name != "A")
                indices.push_back(static_cast<std::size_t>(channel.a - image.channels.data()));
        return indices;
    }
    return indices;
}

using Values = std::vector<float>;

void shiftRight(Values& values, std::size_t width) {
    for (std::size_t i = values.size(); i-- > 1;)
        if (i % width != 0) values[i] = values[i - 1];
}

struct Fault {
    const char* name;
    const char* kind; ///< of the finding that it must lead to whatever the limits; "": the errors decide
    std::function<void(Image& image, const std::vector<std::size_t>& targets)> inject;
};

Fault onEach(const char* name, const char* kind,
             std::function<void(Values& values, std::size_t width)> change) {
    return {name, kind, [change](Image& image, const std::vector<std::size_t>& targets) {
                for (const std::size_t c : targets) change(image.channels[c].values, image.width);
            }};
}

Fault onValues(const char* name, const char* kind, float (*change)(float)) {
    return onEach(name, kind, [change](Values& values, std::size_t) {
        std::ranges::transform(values, values.begin(), change);
    });
}

Fault onOne(const char* name, float value) {
    return {name, "non-finite", [value](Image& image, const std::vector<std::size_t>& targets) {
                Values& values = image.channels[targets.front()].values;
                values[values.size() / 2] = value;
            }};
}

std::vector<Fault> allFaults() {
    constexpr float kNan = std::numeric_limits<float>::quiet_NaN(),
                    kInf = std::numeric_limits<float>::infinity();
    return {
        onOne("one NaN", kNan),
        onValues("all NaN", "non-finite", [](float) { return kNan; }),
        onOne("one +Inf", kInf),
        onOne("one -Inf", -kInf),
        onValues("black frame", "black", [](float) { return 0.0f; }),
        onEach("shift by one pixel", "", shiftRight),
        {"channels swapped", "",
         [](Image& image, const std::vector<std::size_t>& targets) {
             if (targets.size() > 1)
                 std::swap(image.channels[targets[0]].values, image.channels[targets[1]].values);
         }},
        onValues("gamma 2.2 applied", "", [](float v) { return v > 0.0f ? std::pow(v, 1.0f / 2.2f) : v; }),
        onValues("error of 1 %", "", [](float v) { return v * 1.01f; }),
        onValues("error of 1 ulp", "",
                 [](float v) { return std::nextafter(v, std::numeric_limits<float>::max()); }),
        {"channel renamed", "channels",
         [](Image& image, const std::vector<std::size_t>& targets) {
             image.channels[targets.front()].name += "_";
         }},
        {"channel of zeros added", "channels",
         [](Image& image, const std::vector<std::size_t>&) {
             image.channels.push_back({"zz", ImageChannel::Type::Float, Values(image.pixelCount()), {}});
         }},
    };
}

/// The figures of a layer once more, by loops too plain to be wrong in the same way.
class PlainFigures {
public:
    PlainFigures(const LayerPair& layer, double peak) : peak_(peak) {
        const std::size_t pixels = layer.channels.front().a->values.size();
        for (std::size_t i = 0; i < pixels; ++i) {
            double largest = 0.0;
            for (const ChannelPair& channel : layer.channels) {
                const double a = channel.a->values[i], b = channel.b->values[i];
                values_.emplace_back(a, b);
                largest = std::max(largest, std::abs(a - b));
            }
            pixelErrors_.push_back(largest);
        }
    }

    /// Nothing for figures that are not computed here.
    std::optional<double> of(Metric metric, double parameter) const {
        switch (metric) {
        case Metric::MaxAbs:
            return *std::ranges::max_element(pixelErrors_);
        case Metric::Mae:
            return mean([](double a, double b) { return std::abs(a - b); });
        case Metric::Mse:
            return mse();
        case Metric::Rmse:
            return std::sqrt(mse());
        case Metric::RelMse:
            return mean([](double a, double b) { return (a - b) * (a - b) / (b * b + 0.01); });
        case Metric::Smape:
            return mean(
                [](double a, double b) { return std::abs(a - b) / (std::abs(a) + std::abs(b) + 0.01); });
        case Metric::Psnr:
            return 10.0 * std::log10(peak_ * peak_ / mse());
        case Metric::Over:
        case Metric::Differing:
            return static_cast<double>(
                       std::ranges::count_if(pixelErrors_, [&](double e) { return e > parameter; })) /
                   static_cast<double>(pixelErrors_.size());
        default:
            return std::nullopt;
        }
    }

private:
    double mse() const {
        return mean([](double a, double b) { return (a - b) * (a - b); });
    }
    template <class Function>
    double mean(Function function) const {
        double sum = 0.0;
        for (const auto& [a, b] : values_) sum += function(a, b);
        return sum / static_cast<double>(values_.size());
    }

    double peak_;
    std::vector<std::pair<double, double>> values_;
    std::vector<double> pixelErrors_;
};

/// Whether the checks of `compared` say of its first layer what plain loops say.
struct ChecksAgree {
    bool agree = true;
    bool areBroken = false; ///< by the plain loops, or by figures that these do not have
};

ChecksAgree checkAgain(const ComparedPair& compared, double peak) {
    ChecksAgree result;
    const LayerPair& layer = compared.pair.layers.front();
    const PlainFigures plain(layer, peak);
    for (const LimitCheck& check : compared.comparison.checks) {
        const std::optional<double> value =
            check.where == layer.name ? plain.of(check.limit.metric, check.limit.parameter) : std::nullopt;
        if (!value) {
            result.areBroken = result.areBroken || !check.passed;
            continue;
        }
        const bool isSame =
            check.value == *value || std::abs(check.value - *value) <= 1e-9 * std::abs(*value);
        const double limit = check.limit.value;
        const bool passes = traitsOf(check.limit.metric).isAtLeast ? *value >= limit : *value <= limit;
        const bool isOnLimit = std::abs(*value - limit) <= 1e-9 * limit;
        result.agree = result.agree && isSame && (passes == check.passed || isOnLimit);
        result.areBroken = result.areBroken || (isOnLimit ? !check.passed : !passes);
    }
    return result;
}

bool hasFinding(const Comparison& comparison, const std::string& kind) {
    return std::ranges::any_of(comparison.findings,
                               [&](const Finding& finding) { return finding.fails && finding.kind == kind; });
}

std::string describe(const ComparedPair& compared) {
    const Comparison& comparison = compared.comparison;
    std::string text;
    for (const Finding& finding : comparison.findings)
        if (finding.fails) text += (text.empty() ? "" : "; ") + finding.text;
    if (text.empty() && !comparison.checks.empty()) {
        const LimitCheck& check = comparison.checks.front();
        text = fmt::format("{}: {} {:.6g} is within {:.6g}", check.where, metricName(check.limit),
                           check.value, check.limit.value);
    }
    if (const auto& shift = comparison.alignment; shift && shift->shifted())
        text += fmt::format("; best shift {:+}, {:+}", -shift->dx, -shift->dy);
    return text;
}

bool isBlack(const Picture& picture, const std::vector<std::size_t>& targets) {
    return std::ranges::all_of(targets, [&](std::size_t c) {
        const Values& values = picture.parts.front().image.channels[c].values;
        return std::ranges::count(values, 0.0f) == std::ssize(values);
    });
}

Injection injectOne(const Fault& fault, const Picture& picture, const std::vector<std::size_t>& targets,
                    const CompareOptions& options) {
    Injection result{fault.name, true, {}, false, {}};
    Picture faulty = picture;
    fault.inject(faulty.parts.front().image, targets);
    const bool isSameStructure =
        faulty.parts.front().image.channels.size() == picture.parts.front().image.channels.size();
    bool changes = !isSameStructure;
    for (std::size_t c = 0; isSameStructure && c < picture.parts.front().image.channels.size(); ++c) {
        const ImageChannel &now = faulty.parts.front().image.channels[c],
                           &was = picture.parts.front().image.channels[c];
        changes = changes || now.name != was.name || now.values != was.values;
    }
    const bool isAllowed = options.allowed.contains(fault.kind);
    result.applies = changes && !(isAllowed && std::string(fault.kind) == "channels");
    if (!result.applies) {
        result.asExpected = true;
        result.found = isAllowed ? "is allowed" : "changes nothing in this picture";
        return result;
    }
    const ComparedPair compared = comparePictures(std::move(faulty), Picture(picture), options);
    result.found = describe(compared);
    result.expected = isAllowed ? "" : fault.kind;
    // A black picture is black no more, by whatever error.
    if (result.expected.empty() && !options.allowed.contains("black") && isBlack(picture, targets))
        result.expected = "black";
    if (!result.expected.empty()) {
        result.asExpected = hasFinding(compared.comparison, result.expected);
        return result;
    }
    const ChecksAgree again = checkAgain(compared, options.metrics.peak);
    if (again.areBroken) result.expected = "limit";
    result.asExpected = again.agree && again.areBroken == hasFinding(compared.comparison, "limit") &&
                        again.areBroken == !compared.comparison.passed();
    return result;
}

std::string describe(const std::vector<Injection>& injections) {
    std::string text;
    for (const Injection& injection : injections)
        text += fmt::format("{:<24}{:<13}{:<10}{}\n", injection.fault,
                            !injection.applies           ? "-"
                            : injection.expected.empty() ? "below limits"
                                                         : "caught",
                            injection.asExpected ? "ok" : "WRONG", injection.found);
    return text;
}

nlohmann::json jsonOf(const std::vector<Injection>& injections, const std::string& file) {
    nlohmann::json list = nlohmann::json::array();
    for (const Injection& injection : injections)
        list.push_back(
            {{"fault", injection.fault},
             {"applies", injection.applies},
             {"expected", injection.expected.empty() ? nlohmann::json() : nlohmann::json(injection.expected)},
             {"asExpected", injection.asExpected},
             {"found", injection.found}});
    return {{"schemaVersion", 1}, {"selfTest", list}, {"file", file}};
}

} // namespace

std::vector<Injection> injectFaults(const Picture& picture, const CompareOptions& options) {
    const std::vector<std::size_t> targets = targetChannels(picture.parts.front().image);
    if (targets.empty())
        throw Error(ErrorKind::InvalidContent,
                    picture.name + ": has no channel of numbers to put faults into");
    const ComparedPair same = comparePictures(Picture(picture), Picture(picture), options);
    if (!same.comparison.passed())
        throw Error(ErrorKind::InvalidContent,
                    fmt::format("{}: does not pass against itself: {}", picture.name, describe(same)));
    std::vector<Injection> injections;
    for (const Fault& fault : allFaults()) injections.push_back(injectOne(fault, picture, targets, options));
    return injections;
}

int runSelfTest(const Options& options) {
    const FocusOptions& focus = options.compare.focus;
    if (focus.crop || !focus.ignored.empty() || !options.maskPath.empty() || !focus.onlyChannels.empty() ||
        !focus.withoutChannels.empty() || options.compare.noise.on || !options.secondPath.empty())
        throw Error(ErrorKind::Usage,
                    "--self-test compares the whole picture, without --noise; leave out what limits it");
    const Picture picture = readPicture(options.pathA, options.reading);
    const std::vector<Injection> injections = injectFaults(picture, options.compare);
    if (!options.common.jsonPath.empty())
        writeJson(options.common.jsonPath, jsonOf(injections, picture.name));
    if (!options.common.quiet && options.common.jsonPath != "-") writeFile("-", describe(injections));
    const auto wrong = std::ranges::count(injections, false, &Injection::asExpected);
    if (wrong > 0)
        throw Error(ErrorKind::Internal,
                    fmt::format("{} of {} faults were judged wrongly", wrong, injections.size()));
    return 0;
}

} // namespace rt

#include "tools/rt-compare/self_test.h"

#include "common/binary_io.h"
#include "common/error.h"
#include "common/json_file.h"
#include "tools/rt-compare/faults.h"
#include "tools/rt-compare/plain_figures.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

namespace rt {
namespace {

bool hasFinding(const Comparison& comparison, FindingKind kind) {
    return std::ranges::any_of(comparison.findings,
                               [&](const Finding& finding) { return finding.fails && finding.kind == kind; });
}

// What was said of a picture with a fault in this layer.
std::string describe(const Comparison& comparison, const std::string& layer) {
    std::string text;
    for (const Finding& finding : comparison.findings)
        if (finding.fails) text += (text.empty() ? "" : "; ") + finding.text;
    if (text.empty()) {
        const auto check = std::ranges::find(comparison.checks, layer, &LimitCheck::where);
        text = check == comparison.checks.end()
                   ? fmt::format("no limit holds {}", layer)
                   : fmt::format("{}: {} {:.6g} is within {:.6g}", check->where, metricName(check->limit),
                                 check->value, check->limit.value);
    }
    if (const auto& shift = comparison.alignment; shift && shift->shifted())
        text += fmt::format("; best shift {:+}, {:+}", -shift->dx, -shift->dy);
    return text;
}

bool haveSameChannels(const PreparedPair& pair, std::size_t part) {
    return std::ranges::equal(pair.a.parts[part].image.channels, pair.b.parts[part].image.channels, {},
                              &ImageChannel::name, &ImageChannel::name);
}

/// Whether the checks of a comparison say of a layer what plain loops say.
struct ChecksAgree {
    bool agree = true;
    bool areBroken = false; ///< by the plain loops, or by figures that these do not have
};

ChecksAgree checkAgain(const Comparison& comparison, const std::string& layer, const PlainFigures& plain) {
    ChecksAgree result;
    for (const LimitCheck& check : comparison.checks) {
        const std::optional<double> value =
            check.where == layer ? plain.of(check.limit.metric, check.limit.parameter) : std::nullopt;
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

class SelfTest {
public:
    SelfTest(const Picture& picture, const CompareOptions& options, const Picture* mask)
        : picture_(picture), options_(options), mask_(mask) {}

    std::vector<Injection> run() const {
        const PairResult same = compare(Picture(picture_));
        if (!same.comparison.passed())
            throw Error(ErrorKind::InvalidContent, fmt::format("{}: does not pass against itself: {}",
                                                               picture_.name, describe(same.comparison, "")));
        std::vector<Injection> injections;
        for (const FaultPlace& place : faultPlaces(picture_, *same.pair))
            for (const Fault& fault : faultsFor(place)) injections.push_back(inject(fault, place));
        return injections;
    }

private:
    bool isAllowed(FindingKind kind) const { return options_.allowed.contains(kind); }

    PairResult compare(Picture&& faulty) const {
        return comparePictures(std::move(faulty), Picture(picture_), options_, {mask_, nullptr});
    }

    Injection inject(const Fault& fault, const FaultPlace& place) const {
        Injection result{place.layer, fault.name, true, {}, false, {}};
        if (fault.kind == FindingKind::Channels && isAllowed(FindingKind::Channels)) {
            result.applies = false;
            result.asExpected = true;
            result.found = "is allowed";
            return result;
        }
        Picture faulty = picture_;
        fault.inject(faulty.parts[place.part].image, place);
        const PairResult compared = compare(std::move(faulty));
        result.found = describe(compared.comparison, place.layer);
        judge(fault, place, compared, result);
        return result;
    }

    void judge(const Fault& fault, const FaultPlace& place, const PairResult& compared,
               Injection& result) const {
        const Comparison& comparison = compared.comparison;
        if (!haveSameChannels(*compared.pair, place.part)) {
            result.expected = FindingKind::Channels;
            result.asExpected = hasFinding(comparison, FindingKind::Channels);
            return;
        }
        const auto layer = std::ranges::find(compared.pair->layers, place.layer, &LayerPair::name);
        const PlainFigures plain(*layer, compared.pair->regions[place.part], options_.metrics.peak);
        if (plain.isEqual()) {
            result.applies = false;
            result.asExpected = comparison.passed();
            result.found = "changes nothing that is compared";
            return;
        }
        const ChecksAgree again = checkAgain(comparison, place.layer, plain);
        const bool turnsBlack = place.kind != LayerKind::Ids && !isAllowed(FindingKind::Black) &&
                                plain.isBlackIn(&ChannelPair::a) != plain.isBlackIn(&ChannelPair::b);
        if (plain.nonFiniteDiffers())
            result.expected = FindingKind::NonFinite;
        else if (turnsBlack)
            result.expected = FindingKind::Black;
        else if (again.areBroken)
            result.expected = FindingKind::Limit;
        const bool isKindRight = !fault.kind || isAllowed(*fault.kind) || hasFinding(comparison, *fault.kind);
        const bool isFound = result.expected ? hasFinding(comparison, *result.expected) : comparison.passed();
        result.asExpected = isKindRight && isFound && (plain.nonFiniteDiffers() || again.agree);
    }

    const Picture& picture_;
    const CompareOptions& options_;
    const Picture* mask_;
};

std::string describe(const std::vector<Injection>& injections) {
    std::size_t width = 0;
    for (const Injection& injection : injections) width = std::max(width, injection.layer.size() + 2);
    std::string text;
    for (const Injection& injection : injections)
        text += fmt::format("{:<{}}{:<24}{:<13}{:<10}{}\n", injection.layer, width, injection.fault,
                            !injection.applies   ? "-"
                            : injection.expected ? "caught"
                                                 : "below limits",
                            injection.asExpected ? "ok" : "WRONG", injection.found);
    return text;
}

nlohmann::json jsonOf(const std::vector<Injection>& injections, const std::string& file) {
    nlohmann::json list = nlohmann::json::array();
    for (const Injection& injection : injections)
        list.push_back({{"layer", injection.layer},
                        {"fault", injection.fault},
                        {"applies", injection.applies},
                        {"expected", injection.expected ? nlohmann::json(traitsOf(*injection.expected).name)
                                                        : nlohmann::json()},
                        {"asExpected", injection.asExpected},
                        {"found", injection.found}});
    return {{"schemaVersion", 1}, {"selfTest", list}, {"file", file}};
}

} // namespace

std::vector<Injection> injectFaults(const Picture& picture, const CompareOptions& options,
                                    const Picture* mask) {
    return SelfTest(picture, options, mask).run();
}

int runSelfTest(const Options& options) {
    if (options.compare.noise.on)
        throw Error(ErrorKind::Usage,
                    "--self-test holds a picture against itself, which has no other noise; leave out --noise "
                    "and --second-seed");
    const Picture picture = readPicture(options.pathA, options.reading);
    const std::optional<Picture> mask = options.maskPath.empty()
                                            ? std::nullopt
                                            : std::optional(readPicture(options.maskPath, options.reading));
    const std::vector<Injection> injections = injectFaults(picture, options.compare, mask ? &*mask : nullptr);
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

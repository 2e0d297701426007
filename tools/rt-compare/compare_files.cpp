#include "tools/rt-compare/compare_files.h"

#include "common/error.h"
#include "formats/parallel_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

namespace rt {
namespace {

std::optional<Picture> readOptional(const std::string& path, const PictureLimits& limits) {
    if (path.empty()) return std::nullopt;
    return readPicture(path, limits);
}

PairResult missing(const FilePair& pair, bool allowed) {
    const bool isInA = pair.b.empty();
    return {
        pair.a,
        pair.b,
        {},
        fmt::format("{}: is only among the {} images", isInA ? pair.a : pair.b, isInA ? "first" : "second"),
        allowed ? 0 : kExitImagesDiffer};
}

struct Outcome {
    PairResult result;
    std::optional<PreparedPair> pair;
};

Outcome comparePair(const FilePair& pair, const Options& options, const Picture* mask) {
    if (pair.a.empty() || pair.b.empty())
        return {missing(pair, options.compare.allowed.contains("files")), {}};
    Picture a, b;
    std::optional<Picture> second;
    checkTogether({[&] { a = readPicture(pair.a, options.reading); },
                   [&] { b = readPicture(pair.b, options.reading); },
                   [&] { second = readOptional(secondPathFor(pair, options), options.reading); }});
    CompareOptions compare = options.compare;
    compare.focus.mask = mask;
    compare.noise.second = second ? &*second : nullptr;
    ComparedPair compared = comparePictures(std::move(a), std::move(b), compare);
    const int exitCode = compared.comparison.passed() ? 0 : kExitImagesDiffer;
    return {{pair.a, pair.b, std::move(compared.comparison), {}, exitCode, std::move(compared.maps)},
            std::move(compared.pair)};
}

Outcome compareOneOfMany(const FilePair& pair, const Options& options, const Picture* mask) {
    try {
        return comparePair(pair, options, mask);
    } catch (const Error& error) {
        return {{pair.a, pair.b, {}, error.what(), static_cast<int>(error.kind())}, {}};
    }
}

} // namespace

std::string secondPathFor(const FilePair& pair, const Options& options) {
    std::error_code ignored;
    if (options.secondPath.empty() || !std::filesystem::is_directory(options.secondPath, ignored))
        return options.secondPath;
    const std::filesystem::path b(pair.b);
    const auto relative = std::filesystem::is_directory(options.pathB, ignored)
                              ? b.lexically_relative(options.pathB)
                              : b.filename();
    return (options.secondPath / relative).string();
}

int comparePairs(const std::vector<FilePair>& pairs, const Options& options, const PairSink& sink) {
    const std::optional<Picture> mask = readOptional(options.maskPath, options.reading);
    Options effective = options;
    if (std::ranges::all_of(pairs, [](const FilePair& pair) { return pair.a.empty() || pair.b.empty(); }))
        effective.compare.allowed.erase("files"); // else nothing at all would be compared, and pass
    int exitCode = 0;
    for (const FilePair& pair : pairs) {
        const auto compareIt = pairs.size() == 1 ? comparePair : compareOneOfMany;
        const Outcome outcome = compareIt(pair, effective, mask ? &*mask : nullptr);
        sink(outcome.result, outcome.pair ? &*outcome.pair : nullptr);
        if (exitCode <= kExitImagesDiffer) exitCode = std::max(exitCode, outcome.result.exitCode);
    }
    return exitCode;
}

} // namespace rt

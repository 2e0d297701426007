#include "tools/rt-compare/compare_files.h"

#include "common/error.h"
#include "formats/parallel_check.h"

#include <algorithm>
#include <filesystem>

namespace rt {
namespace {

std::optional<Picture> readOptional(const std::string& path, const PictureLimits& limits) {
    if (path.empty()) return std::nullopt;
    return readPicture(path, limits);
}

PairResult unread(const FilePair& pair, const std::string& problem, int exitCode) {
    PairResult result;
    result.nameA = pair.a;
    result.nameB = pair.b;
    result.problem = problem;
    result.exitCode = exitCode;
    return result;
}

PairResult comparePair(const FilePair& pair, const Options& options, const Picture* mask) {
    if (pair.a.empty() || pair.b.empty())
        return unread(pair,
                      pair.b.empty() ? pair.a + ": is only among the first images"
                                     : pair.b + ": is only among the second images",
                      options.compare.allowed.contains(FindingKind::Files) ? 0 : kExitImagesDiffer);
    Picture a, b;
    std::optional<Picture> second;
    checkTogether({[&] { a = readPicture(pair.a, options.reading); },
                   [&] { b = readPicture(pair.b, options.reading); },
                   [&] { second = readOptional(secondPathFor(pair, options), options.reading); }});
    PairResult result =
        comparePictures(std::move(a), std::move(b), options.compare, {mask, second ? &*second : nullptr});
    result.nameA = pair.a;
    result.nameB = pair.b;
    std::error_code ignored; // standard input is no file
    if (std::filesystem::equivalent(pair.a, pair.b, ignored))
        result.comparison.notes.push_back("both names are the same file, which is compared with itself");
    return result;
}

PairResult compareOneOfMany(const FilePair& pair, const Options& options, const Picture* mask) {
    try {
        return comparePair(pair, options, mask);
    } catch (const Error& error) {
        return unread(pair, error.what(), static_cast<int>(error.kind()));
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
        effective.compare.allowed.erase(
            FindingKind::Files); // else nothing at all would be compared, and pass
    int exitCode = 0;
    for (const FilePair& pair : pairs) {
        const auto compareIt = pairs.size() == 1 ? comparePair : compareOneOfMany;
        const PairResult result = compareIt(pair, effective, mask ? &*mask : nullptr);
        sink(result);
        if (exitCode <= kExitImagesDiffer) exitCode = std::max(exitCode, result.exitCode);
    }
    return exitCode;
}

} // namespace rt

#pragma once
#include "tools/rt-compare/file_pairs.h"
#include "tools/rt-compare/options.h"
#include "tools/rt-compare/verdict.h"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace rt {

/// What became of one pair of files.
struct PairResult {
    std::string nameA, nameB;              ///< empty: there is no such file
    std::optional<Comparison> comparison;  ///< absent if a file could not be read or is missing
    std::string problem;                   ///< why it is absent
    int exitCode = 0;                      ///< of this pair alone
    std::vector<PerceptionMaps> maps = {}; ///< of the layers, as far as they were asked for

    Verdict verdict() const { return verdictOf(exitCode); }
};

/// Is given each result in order, with the pictures where they were compared.
using PairSink = std::function<void(const PairResult& result, const PreparedPair* pair)>;

/// The second render of the pair's reference: in a folder of them the one with its name; empty if none is
/// wanted.
std::string secondPathFor(const FilePair& pair, const Options& options);

/// Compares every pair, one at a time. Of a single pair that cannot be read, the error is thrown; of several,
/// it is the pair's result. Returns the exit code of all: that of the first pair that could not be read, else
/// 1 if any differ or lacks its partner.
int comparePairs(const std::vector<FilePair>& pairs, const Options& options, const PairSink& sink);

} // namespace rt

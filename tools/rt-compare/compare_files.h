#pragma once
#include "tools/rt-compare/file_pairs.h"
#include "tools/rt-compare/options.h"

#include <functional>
#include <string>
#include <vector>

namespace rt {

/// Is given each result in order.
using PairSink = std::function<void(const PairResult& result)>;

/// The file of --second-seed for a pair: in a folder of second renders the one with the reference's name.
/// Empty: none is wanted.
std::string secondPathFor(const FilePair& pair, const Options& options);

/// The second render of the pair's reference: in a folder of them the one with its name; empty if none is
/// wanted.
std::string secondPathFor(const FilePair& pair, const Options& options);

/// Compares every pair, one at a time. Of a single pair that cannot be read, the error is thrown; of several,
/// it is the pair's result. Returns the exit code of all: that of the first pair that could not be read, else
/// 1 if any differ or lacks its partner.
int comparePairs(const std::vector<FilePair>& pairs, const Options& options, const PairSink& sink);

} // namespace rt

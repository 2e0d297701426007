#pragma once
#include "tools/rt-compare/comparison.h"
#include "tools/rt-compare/perception.h"
#include "tools/rt-compare/prepared_pair.h"
#include "tools/rt-compare/verdict.h"

#include <optional>
#include <string>
#include <vector>

namespace rt {

/// What became of two pictures.
struct PairResult {
    std::string nameA, nameB;         ///< as they were named; empty: there is no such file
    std::string problem;              ///< why they were not compared
    int exitCode = 0;                 ///< of this pair alone
    std::optional<PreparedPair> pair; ///< absent if a file could not be read or is missing
    Comparison comparison;            ///< of the pair
    std::vector<PerceptionMaps> maps; ///< of the pair's layers, as far as they were asked for

    Verdict verdict() const { return verdictOf(exitCode); }
};

} // namespace rt

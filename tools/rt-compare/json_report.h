#pragma once
#include "tools/rt-compare/pair_result.h"

#include <nlohmann/json_fwd.hpp>

namespace rt {

/// The figures of a pair for programs: one element of `pairs` in README.md.
nlohmann::json jsonReport(const PairResult& result);

/// The whole file: `pairs` are what jsonReport() gave.
nlohmann::json jsonFile(nlohmann::json pairs, const Totals& totals);

} // namespace rt

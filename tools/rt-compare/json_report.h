#pragma once
#include "tools/rt-compare/compare_files.h"

#include <nlohmann/json_fwd.hpp>

namespace rt {

/// The figures of a pair for programs: one element of `pairs` in README.md. `pair` as PairSink has it.
nlohmann::json jsonReport(const PairResult& result, const PreparedPair* pair);

/// The whole file: `pairs` are what jsonReport() gave.
nlohmann::json jsonFile(nlohmann::json pairs, const Totals& totals);

} // namespace rt

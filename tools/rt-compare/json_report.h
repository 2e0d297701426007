#pragma once
#include "tools/rt-compare/run.h"

#include <nlohmann/json_fwd.hpp>

namespace rt {

/// The figures of a pair for programs; see README.md. `pair` as PairSink has it.
nlohmann::json jsonReport(const PairResult& result, const PreparedPair* pair);

} // namespace rt

#pragma once
#include "tools/rt-compare/pair_result.h"

#include <string>

namespace rt {

/// What was found about one pair, for people, with units. `colored`: with a
/// terminal's colors for what passes and what fails.
std::string textReport(const PairResult& result, bool colored);

/// The last line for several pairs.
std::string textSummary(const Totals& totals);

} // namespace rt

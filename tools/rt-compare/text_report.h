#pragma once
#include "tools/rt-compare/run.h"

#include <string>

namespace rt {

/// What was found about one pair, for people, with units. `pair` as PairSink has it. `colored`: with a
/// terminal's colors for what passes and what fails.
std::string textReport(const PairResult& result, const PreparedPair* pair, bool colored);

/// The last line for several pairs.
std::string textSummary(std::size_t pairs, std::size_t differing, std::size_t unreadable);

} // namespace rt

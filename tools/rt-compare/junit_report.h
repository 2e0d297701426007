#pragma once
#include "tools/rt-compare/verdict.h"

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace rt {

/// The pairs, as jsonReport() gives them, as test cases of one suite, as JUnit readers of CI systems take
/// them: pairs that differ are failures, pairs that cannot be compared are errors.
std::string junitReport(const nlohmann::json& pairs, const Totals& totals);

} // namespace rt

#pragma once
#include "tools/rt-compare/comparison.h"
#include "tools/rt-compare/prepared_pair.h"

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace rt {

/// One comparison, for the reports.
struct ReportedPair {
    const std::string& nameA;
    const std::string& nameB;
    const PreparedPair& pair;
    const Comparison& comparison;
};

/// Lines for people, with units: what was compared, the figures of each layer and channel, why it fails.
/// `colored`: with a terminal's colours for what fails and what passes.
std::string textReport(const ReportedPair& reported, bool colored);

/// The same figures for programs: one element of `pairs` of README.md's schema.
nlohmann::json jsonReport(const ReportedPair& reported);

/// The whole file, schemaVersion 2: `pairs` are what jsonReport() gave.
nlohmann::json jsonFile(nlohmann::json pairs);

/// The pairs as test cases of one suite, as JUnit readers of CI systems take them.
std::string junitReport(const nlohmann::json& pairs);

} // namespace rt

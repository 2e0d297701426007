#pragma once
#include "tools/rt-compare/metrics.h"

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace rt {

/// What was compared, for the reports.
struct ComparedFiles {
    std::string nameA, nameB;
    const Image& a;
    const Image& b;
    double maxRmse;
};

/// A few lines for people, with units.
std::string textReport(const ComparedFiles& files, const Comparison& comparison);

/// The same figures for programs, schemaVersion 1; see README.md.
nlohmann::json jsonReport(const ComparedFiles& files, const Comparison& comparison);

} // namespace rt

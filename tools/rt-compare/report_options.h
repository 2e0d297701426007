#pragma once
#include "tools/rt-compare/heat_map.h"
#include "tools/rt-compare/limits.h"

#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
} // namespace CLI

namespace rt {

/// Reports beside the text and --json.
struct ReportOptions {
    std::vector<std::string> heatPaths; ///< .exr or .png
    HeatFigure heat = HeatFigure::Flip;
    std::string junitPath, htmlPath; ///< empty: none
    /// Reports that show the pixels of one pair only.
    bool showsPixels() const { return !heatPaths.empty() || !htmlPath.empty(); }
    /// All files that will be written.
    std::vector<std::string> outputs() const;
};

/// What the command line says before it is understood.
struct ReportTexts {
    std::vector<std::string> metrics;
    std::string exposures, heat;
};

/// Adds an option that takes names with commas between them.
CLI::Option* namesOption(CLI::App& app, const std::string& option, std::vector<std::string>& names,
                         const std::string& help, const std::string& group);

void addReportOptions(CLI::App& app, ReportTexts& texts, ReportOptions& reports,
                      PerceptionOptions& perception);

/// Understands the texts, and asks for what the limits, metrics and reports need. Throws Error{Usage}.
void readReportOptions(const ReportTexts& texts, const std::vector<Limit>& limits, ReportOptions& reports,
                       PerceptionOptions& perception);

} // namespace rt

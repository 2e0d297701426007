#pragma once
#include <string_view>

namespace rt {

enum class LogLevel { Quiet, Normal, Verbose };

/// Everything the log prints goes to standard error, prefixed by the tool's name; results go to standard
/// output and are not the log's business.
void setLogLevel(LogLevel level);
LogLevel logLevel();
void setToolName(std::string_view name);

/// "rt-grid: message"; hidden by -q.
void logInfo(std::string_view message);
/// Shown with -v only.
void logDetail(std::string_view message);
/// "rt-grid: warning: message"; hidden by -q.
void logWarning(std::string_view message);
/// "rt-grid: error: message"; always shown.
void logError(std::string_view message);

} // namespace rt

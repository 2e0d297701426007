#include "common/log.h"

#include <cstdio>
#include <string>

namespace rt {
namespace {

struct LogState {
    LogLevel level = LogLevel::Normal;
    std::string tool = "rt-tools";
};

LogState& state() {
    static LogState instance;
    return instance;
}

void print(std::string_view prefix, std::string_view message) {
    std::string line = state().tool;
    line.append(": ").append(prefix).append(message).append("\n");
    std::fwrite(line.data(), 1, line.size(), stderr);
}

} // namespace

void setLogLevel(LogLevel level) {
    state().level = level;
}
LogLevel logLevel() {
    return state().level;
}
void setToolName(std::string_view name) {
    state().tool = name;
}

void logInfo(std::string_view message) {
    if (state().level >= LogLevel::Normal) print("", message);
}

void logDetail(std::string_view message) {
    if (state().level >= LogLevel::Verbose) print("", message);
}

void logWarning(std::string_view message) {
    if (state().level >= LogLevel::Normal) print("warning: ", message);
}

void logError(std::string_view message) {
    print("error: ", message);
}

} // namespace rt

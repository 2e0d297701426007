#pragma once
#include <stdexcept>
#include <string>

namespace rt {

/// What went wrong, and the exit code that every tool ends with for it.
enum class ErrorKind {
    Usage = 2,
    FileAccess = 3,
    InvalidContent = 4,
    LimitExceeded = 5,
    NoGpu = 6,
    Internal = 70,
};

/// Exit code of rt-compare for images that differ; not an error.
inline constexpr int kExitImagesDiffer = 1;

/// Bad input or environment. The message says file, what was found, the limit, the remedy; one line.
class Error : public std::runtime_error {
public:
    Error(ErrorKind kind, const std::string& message) : std::runtime_error(message), kind_(kind) {}
    ErrorKind kind() const { return kind_; }

private:
    ErrorKind kind_;
};

/// The exit-code table as --help prints it.
std::string exitCodeTable();

} // namespace rt

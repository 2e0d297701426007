#pragma once

namespace rt {

/// `rt-grid verify`: proves an atlas and says what was found. argv[0] is "verify". Returns the exit code.
/// Throws Error{InvalidContent} if the proof fails, after the report.
int verifyCommand(int argc, const char* const* argv);

} // namespace rt

#pragma once

namespace rt {

/// `rt-grid` without a command's name: builds an atlas, or with --dry-run says what that would take. Returns
/// the exit code.
int buildCommand(int argc, const char* const* argv);

} // namespace rt

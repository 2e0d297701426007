#pragma once

namespace rt {

/// `rt-grid inspect`: says what is in an atlas, and shows it as pictures and OpenVDB grids. argv[0] is
/// "inspect". Returns the exit code.
int inspectCommand(int argc, const char* const* argv);

} // namespace rt

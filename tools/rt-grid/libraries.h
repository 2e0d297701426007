#pragma once
#include <string>

namespace rt {

/// The libraries of rt-grid and their versions, for --version.
std::string gridLibraries();

} // namespace rt

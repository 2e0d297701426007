#pragma once
#include "tools/rt-compare/pair_result.h"

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace rt {

/// Larger pictures are shown smaller on a page; the figures are those of the whole ones.
inline constexpr std::uint64_t kMaxPagePixels = std::uint64_t(1) << 21;

/// One page with all that it needs inside: the pictures of the first part's layers of colours as half floats,
/// the maps of all its layers, and the figures of `report`, which jsonReport() gave of the result. It loads
/// nothing and runs no script but its own.
std::string htmlReport(const nlohmann::json& report, const PairResult& result);

} // namespace rt

#pragma once
#include "tools/rt-compare/prepared_pair.h"

#include <optional>

namespace rt {

/// The shift of at most `maxShift` pixels along each axis that makes the first color layer (or, without one,
/// the first layer of numbers) most alike, if its RMSE is less by a tenth than without, measured over the
/// pixels that every shift keeps inside: at first on a sample of rows, the best few on more of them. Nothing
/// if the layer does not differ, or is too small to shift.
std::optional<Alignment> findAlignment(const PreparedPair& pair, const Comparison& comparison, int maxShift);

} // namespace rt

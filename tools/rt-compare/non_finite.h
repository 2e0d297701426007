#pragma once
#include "tools/rt-compare/prepared_pair.h"

namespace rt {

/// Fills the comparison's counts and places of values that are NaN or infinite, and adds findings: any such
/// value fails, unless `allowSame` and the other picture has the same kind of it in the same channel and
/// pixel.
void findNonFinite(const PreparedPair& pair, bool allowSame, Comparison& comparison);

} // namespace rt

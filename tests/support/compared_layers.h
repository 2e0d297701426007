#pragma once
#include "tools/rt-compare/comparison.h"

#include <algorithm>

namespace rt::test {

/// R, G, B, A of the first part; nullptr if absent.
inline const LayerComparison* colorOf(const Comparison& comparison) {
    const auto found = std::ranges::find(comparison.layers, LayerKind::Color, &LayerComparison::kind);
    return found == comparison.layers.end() ? nullptr : &*found;
}

} // namespace rt::test

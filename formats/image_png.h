#pragma once
#include "formats/image.h"

#include <cstddef>
#include <vector>

namespace rt {

/// The bytes of an 8-bit PNG of the image's R, G, B and, where present, A channels: clamped to [0,1],
/// sRGB-encoded (not A); not-finite values become 0. Throws Error{Usage} if R, G or B is missing.
std::vector<std::byte> encodePng(const Image& image);

} // namespace rt

#pragma once
#include "formats/image.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace rt {

/// Decodes a Radiance HDR picture: channels B, G, R. Safe for untrusted bytes. Throws Error{InvalidContent}
/// prefixed by `name`, Error{LimitExceeded} above `maxPixels` or 2^27 pixels.
Image decodeHdr(std::span<const std::byte> bytes, const std::string& name,
                std::uint64_t maxPixels = std::uint64_t(1) << 27);

} // namespace rt

#pragma once
#include "formats/image.h"

#include <cstddef>
#include <span>
#include <string>

namespace rt {

/// Decodes a Radiance HDR picture: channels B, G, R. Safe for untrusted bytes. Throws Error{InvalidContent}
/// prefixed by `name`, Error{LimitExceeded} above 2^27 pixels.
Image decodeHdr(std::span<const std::byte> bytes, const std::string& name);

} // namespace rt

#pragma once
#include "formats/image.h"

#include <cstddef>
#include <span>
#include <vector>

namespace rt {

/// The bytes of a single-part scanline EXR, ZIP-compressed. Same image, same bytes. Finite values beyond the
/// range of a Half channel become +-65504, the largest it holds.
std::vector<std::byte> encodeExr(const Image& image);

/// Decodes all channels of a single-part EXR (scanline or tiled) whose compression is NONE, RLE, ZIPS or ZIP.
/// Safe for untrusted bytes. Throws Error{InvalidContent} prefixed by `name`, Error{LimitExceeded} above 2^28
/// pixels.
Image decodeExr(std::span<const std::byte> bytes, const std::string& name);

/// decodeExr() of a file; "-" is standard input. Throws Error{FileAccess} too.
Image readExr(const std::string& path);

} // namespace rt

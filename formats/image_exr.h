#pragma once
#include "formats/image.h"
#include "formats/picture.h"

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

/// Decodes all parts of an EXR (scanline or tiled, of which the full size is read). A channel that has one
/// value for a block of pixels has it for each of them here. Safe for untrusted bytes, unless
/// limits.allCompressions. Throws Error{InvalidContent} or Error{LimitExceeded} prefixed by `name`.
std::vector<PicturePart> decodeExrParts(std::span<const std::byte> bytes, const std::string& name,
                                        const PictureLimits& limits);

/// decodeExr() of a file; "-" is standard input. Throws Error{FileAccess} too.
Image readExr(const std::string& path);

} // namespace rt

#pragma once
#include "formats/image.h"
#include "formats/picture.h"

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace rt {

/// The bytes of an 8-bit PNG of the image's R, G, B and, where present, A channels: clamped to [0,1],
/// sRGB-encoded (not A); not-finite values become 0. Of the image's texts it has kRecipeKey. Throws
/// Error{Usage} if R, G or B is missing.
std::vector<std::byte> encodePng(const Image& image);

/// Decodes a PNG of 8 or 16 bits (fewer become 8, palettes become colours): R, G, B or Y, and A where it has
/// opacity; stored number over the largest one, 0 to 1, as they are encoded. Safe for untrusted bytes. Throws
/// Error{InvalidContent} or Error{LimitExceeded} prefixed by `name`.
Picture decodePng(std::span<const std::byte> bytes, const std::string& name, const PictureLimits& limits);

bool isPng(std::span<const std::byte> bytes);

/// What stands before a text in its chunk: type, key, 0.
std::string pngTextHead(const std::string& key);

inline constexpr std::size_t kPngCrcBytes = 4;
/// What stands behind a chunk: of its type and data.
std::array<std::byte, kPngCrcBytes> pngCrc(std::span<const std::byte> chunk);

} // namespace rt

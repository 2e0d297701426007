#pragma once
#include "formats/picture.h"

#include <cstddef>
#include <span>
#include <string>

namespace rt {

/// Decodes a JPEG of grey (Y) or colour (R, G, B): stored number over 255, as they are encoded. What the
/// library would only warn of (missing or surplus data) is an error. Safe for untrusted bytes. Throws
/// Error{InvalidContent} or Error{LimitExceeded} prefixed by `name`.
Picture decodeJpeg(std::span<const std::byte> bytes, const std::string& name, const PictureLimits& limits);

} // namespace rt

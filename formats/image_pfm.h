#pragma once
#include "formats/picture.h"

#include <cstddef>
#include <span>
#include <string>

namespace rt {

/// Decodes a PFM ("portable float map"): R, G, B ("PF") or Y ("Pf"); of its scale only the sign counts, which
/// is the byte order. Safe for untrusted bytes. Throws Error{InvalidContent} or Error{LimitExceeded} prefixed
/// by `name`. Source: Debevec's description of the format (HDR Shop).
Picture decodePfm(std::span<const std::byte> bytes, const std::string& name, const PictureLimits& limits);

} // namespace rt

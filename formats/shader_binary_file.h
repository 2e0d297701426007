#pragma once
#include "common/binary_io.h"

#include <cstdint>
#include <string>

namespace rt {

/// A shader as a driver compiled it, for that driver alone.
struct ShaderBinary {
    std::uint64_t key = 0;    ///< hash of what it was made from, and by whom
    std::uint32_t format = 0; ///< of glProgramBinary()
    SharedSpan<std::byte> bytes;
};

/// Writes it whole or not at all. Throws Error{FileAccess}.
void writeShaderBinary(const std::string& path, const ShaderBinary& binary);

/// Safe for untrusted files; what is in `bytes` is the driver's business. Throws Error{FileAccess} or
/// Error{InvalidContent}.
ShaderBinary readShaderBinary(const std::string& path);

} // namespace rt

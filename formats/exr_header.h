#pragma once
#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace rt {

inline constexpr std::size_t kExrStartBytes = 8; ///< magic number and version

/// Throws Error{InvalidContent} prefixed by `name` unless `bytes` are the start of an EXR file.
void requireExrMagic(std::span<const std::byte> bytes, const std::string& name);

/// The leading bytes of an EXR file up to the end of its header, made safe for a library to parse: attributes
/// that it would read beyond their declared size (previews, manifests, lists of strings) get an unknown type,
/// so that they are carried as plain bytes, and the sizes of the others are checked, so that it walks the
/// header in the same steps. Throws Error{InvalidContent} prefixed by `name` if the file is not an EXR, is
/// damaged, holds deep pixels, or several parts where these are not wanted. Source: "OpenEXR File Layout"
/// (openexr.com).
struct SafeExrHeader {
    std::vector<std::byte> bytes;
    std::size_t parts = 0;
    bool multiPart = false; ///< how the file is laid out; such a file may have one part only
};
SafeExrHeader safeExrHeader(std::span<const std::byte> file, const std::string& name, bool severalParts);

} // namespace rt

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
/// damaged, multi-part or deep. Source: "OpenEXR File Layout" (openexr.com).
std::vector<std::byte> safeExrHeader(std::span<const std::byte> file, const std::string& name);

} // namespace rt

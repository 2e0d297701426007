#pragma once
#include <cstddef>
#include <string>
#include <vector>

namespace rt {

struct NamedBytes {
    std::string name; ///< without a folder
    std::vector<std::byte> bytes;
};

/// Throws Error{FileAccess} if writeFolder() would certainly fail.
void requireFolderWritable(const std::string& folder);

/// Writes all files into the folder, which is made if it is not there, or none of them: if one fails, or a
/// signal comes, files and folder that were not there before are removed again. Throws Error{FileAccess}.
void writeFolder(const std::string& folder, const std::vector<NamedBytes>& files);

} // namespace rt

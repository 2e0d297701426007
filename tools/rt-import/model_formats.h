#pragma once
#include <string>
#include <vector>

namespace rt {

/// "obj, ply, ...": the extensions that are read without further ado.
std::string readableFormats();

/// Whether files of this extension are read: by itself, or because it is among `allowed` and Assimp has a
/// loader for it.
bool isReadable(const std::string& extension, const std::vector<std::string>& allowed);

/// Throws Error{Usage} for an extension that no loader has, naming --allow-format.
void requireKnownFormat(const std::string& extension);

/// The table that --list-formats prints: extension, how it is read, what Assimp calls it.
std::string formatTable();

} // namespace rt

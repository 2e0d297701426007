#pragma once
#include <string>

namespace rt {

/// What the child that imports tells its parent besides the mesh.
struct ImportMessage {
    std::string filesAsked; ///< FilesAsked::text()
    std::string report;     ///< the --json document, a JSON object
};

/// The files with a 0 behind each; an empty one ends their list. Their names may hold any byte but 0.
std::string toText(const ImportMessage& message);

/// Throws Error{InvalidContent}, prefixed by `name`, for anything that toText() does not make.
ImportMessage readMessage(const std::string& text, const std::string& name);

} // namespace rt

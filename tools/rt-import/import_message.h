#pragma once
#include <string>
#include <vector>

namespace rt {

/// What the child that imports tells its parent besides the mesh.
struct ImportMessage {
    std::vector<std::string> filesRead; ///< the model, its material libraries, buffers and textures
    std::string report;                 ///< the --json document, a JSON object
};

/// Names of files may hold any byte but 0, which ends each here; an empty one ends their list.
std::string toText(const ImportMessage& message);

/// Throws Error{InvalidContent}, prefixed by `name`, for anything that toText() does not make.
ImportMessage readMessage(const std::string& text, const std::string& name);

} // namespace rt

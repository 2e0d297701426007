#pragma once
#include <memory>
#include <string>
#include <vector>

struct aiScene;

namespace rt {

class ModelFolder;

/// A model file as Assimp holds it: polygons cut into triangles, otherwise in the file's own order and
/// indexing.
class OpenModel {
public:
    /// Throws Error{FileAccess} if the file cannot be read, Error{InvalidContent} if its extension is not one
    /// of those that are read or if its content makes no sense to Assimp. `folder` must outlive this object.
    OpenModel(const std::string& path, ModelFolder& folder, std::vector<std::string>& warnings);
    ~OpenModel();
    OpenModel(const OpenModel&) = delete;
    OpenModel& operator=(const OpenModel&) = delete;

    const aiScene& scene() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// "OBJ, PLY, ...": the formats that are read.
std::string readableFormats();

/// "Assimp 5.2.5".
std::string assimpVersion();

} // namespace rt

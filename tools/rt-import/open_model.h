#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

struct aiScene;

namespace rt {

class ModelFolder;
struct ImportSettings;

/// A model file as Assimp holds it: polygons cut into triangles, otherwise in the file's own order and
/// indexing.
class OpenModel {
public:
    /// Of the settings, allowedFormats, progress and the crease count. Throws Error{FileAccess} if the file
    /// cannot be read, Error{InvalidContent} if its extension is not one of those that are read or if its
    /// content makes no sense to Assimp, Error{LimitExceeded} if memory does not suffice for it. `folder`
    /// must outlive this object.
    OpenModel(const std::string& path, const ImportSettings& settings, const ModelFolder& folder,
              std::vector<std::string>& warnings);
    ~OpenModel();
    OpenModel(const OpenModel&) = delete;
    OpenModel& operator=(const OpenModel&) = delete;

    const aiScene& scene() const;
    /// For each face of the mesh, the polygon of the file that it was cut from, counted from 0; empty where
    /// every face is its own.
    const std::vector<std::uint32_t>& polygonsOf(unsigned mesh) const;
    /// Polygons of the mesh that could not be cut into as many triangles as they should.
    const std::vector<std::uint32_t>& badPolygonsOf(unsigned mesh) const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// "Assimp 5.2.5".
std::string assimpVersion();

} // namespace rt

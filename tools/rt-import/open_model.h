#pragma once
#include <cstdint>
#include <functional>
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
    /// `allowedFormats` are extensions that are read besides the usual ones; `progress` is told which part of
    /// the reading is done, 0 to 1. Throws Error{FileAccess} if the file cannot be read,
    /// Error{InvalidContent} if its extension is not one of those that are read or if its content makes no
    /// sense to Assimp, Error{LimitExceeded} if memory does not suffice for it. `folder` must outlive this
    /// object.
    OpenModel(const std::string& path, const std::vector<std::string>& allowedFormats,
              const ModelFolder& folder, std::vector<std::string>& warnings,
              const std::function<void(double)>& progress);
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

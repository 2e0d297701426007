#pragma once
#include "common/binary_io.h"
#include "common/bounds.h"
#include "formats/material.shared.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace rt {

/// A decoded 8-bit image: RGBA, sRGB-encoded colour, straight alpha, top row first.
struct MeshImage {
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    std::uint32_t wrapU = kWrapRepeat;
    std::uint32_t wrapV = kWrapRepeat;
    std::uint64_t firstPixel = 0; ///< index of its first pixel in Mesh::pixels
};
static_assert(sizeof(MeshImage) == 24);

/// An indexed triangle mesh in world space, with all that is needed to shade it.
/// Triangles stand in the imported file's order; a triangle's position is its id everywhere.
struct Mesh {
    SharedSpan<glm::vec3> positions;  ///< one per vertex, world units, finite
    SharedSpan<glm::vec3> normals;    ///< one per vertex, unit length
    SharedSpan<glm::vec2> texcoords;  ///< one per vertex, or none at all; v = 0 is an image's bottom edge
    SharedSpan<glm::uvec3> triangles; ///< three vertex indices each, counter-clockwise from outside
    SharedSpan<std::uint32_t> triangleMaterial; ///< one per triangle: index into materials
    SharedSpan<Material> materials;             ///< at least one
    SharedSpan<Light> lights;                   ///< the file's point lights; may be empty
    SharedSpan<MeshImage> images;
    SharedSpan<std::uint32_t> pixels; ///< of all images; R in the lowest byte
};

/// Bounds of the vertices that triangles use. Empty for a mesh without triangles.
Bounds boundsOf(const Mesh& mesh);

/// Indices of triangles and vertices stay below 2^31.
inline constexpr std::size_t kMaxIndexedCount = 0x7FFFFFFFu;

/// Whether every number is in the range that formats/README.md gives, and the image is one of `imageCount`.
bool isValid(const Material& material, std::size_t imageCount);

/// Throws Error{InvalidContent}, message prefixed by `name`, unless every count, index and number holds what
/// the comments above promise.
void validate(const Mesh& mesh, const std::string& name);

} // namespace rt

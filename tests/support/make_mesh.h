#pragma once
#include "formats/mesh.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace rt::test {

/// Point lights, where it only counts how many there are.
inline const std::vector<Light> kTwoLights(2);

// Meshes made in code. Each is valid per rt::validate(), has one grey matt material, no texture coordinates,
// no lights and no images, unless it says otherwise.

/// The material that all of them have: white-ish, diffuse, no image.
Material greyMaterial();

/// Mesh of the given corners, three per triangle, not shared between triangles; flat normals.
Mesh makeTriangles(const std::vector<glm::vec3>& corners);

/// Mesh of the given vertices and triangles; every normal is +z.
Mesh makeIndexed(std::vector<glm::vec3> positions, std::vector<glm::uvec3> triangles);

/// Closed sphere around the origin: an icosahedron split `subdivisions` times, 20 * 4^subdivisions triangles,
/// shared vertices, smooth outward normals.
Mesh makeSphere(int subdivisions, float radius = 1.0f);

/// Closed torus around the z axis: `around` times `across` quads of two triangles, shared vertices, smooth
/// outward normals. `radius` is that of the tube's middle, `tube` the tube's own.
Mesh makeTorus(float radius, float tube, int around, int across);

/// The square from -1 to 1 of the plane z = 0: `alongX` times `alongY` quads of two triangles, shared
/// vertices.
Mesh makeSheet(int alongX, int alongY);

/// Closed box of 12 triangles, 24 vertices, flat outward normals.
Mesh makeBox(const glm::vec3& lo, const glm::vec3& hi);

/// makeBox() from -0.5 to 0.5.
Mesh makeCube();

/// `count` separate triangles with corners up to `size` from centres that are uniform in the unit cube.
/// Same seed, same mesh.
Mesh makeRandomTriangles(std::size_t count, std::uint64_t seed, float size = 0.1f);

/// `count` slivers across the unit cube, 1e-6 wide, and among them one large triangle for each 20.
Mesh makeSliversAndGiants(int count);

/// `count` triangles in the unit cube that have its middle as a corner.
Mesh makeFan(int count);

/// The triangles of both, in the first one's grey.
Mesh joined(const Mesh& a, const Mesh& b);

/// A unit square in the plane z = 0 with texture coordinates over the whole image, and the given images
/// (width, height each), of which it shows the first. Pixel i of the whole array is 0xFF000000 + i.
Mesh makeTexturedSquare(const std::vector<glm::uvec2>& imageSizes);

/// The mesh with each position p replaced by p * scale + offset.
Mesh moved(const Mesh& mesh, float scale, const glm::vec3& offset);

} // namespace rt::test

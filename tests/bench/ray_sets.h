// The benchmark's rays: camera rays, and what starts where they hit. The same input gives the same bytes,
// whatever the number of threads.
#pragma once
#include "common/bounds.h"
#include "formats/gpu_interface.shared.h"
#include "formats/mesh.h"

#include <cstdint>
#include <span>
#include <vector>

namespace rt::bench {

/// A square pinhole picture.
struct Camera {
    glm::dvec3 eye{0.0};
    glm::dvec3 target{0.0};
    glm::dvec3 up{0.0, 1.0, 0.0};
    double fovDegrees = 45.0; ///< of the picture's side
};

/// Where a camera of 45 degrees is filled by an object: in direction (0.5, 0.35, 1) from the target, 1.875
/// radii (half the diagonal of the bounds) away.
glm::dvec3 framingEye(const Bounds& bounds, const glm::dvec3& target);

/// The default light: 1.5 radii (half the diagonal of the bounds) times (0.4, 1, 0.3) from the centre.
glm::dvec3 lightAbove(const Bounds& bounds);

/// size*size rays of unit direction through the pixels' centres, tmax 1e30. Pixels stand in tiles of 8x4, so
/// that 32 rays in a row are neighbours: tiles row by row from the top left, pixels of a tile likewise.
/// `size` is a multiple of 8. Throws Error{Usage} if the camera has no direction or its up no right angle.
std::vector<QueryRay> primaryRays(const Camera& camera, std::uint32_t size);

/// For each hit of `hits` one ray to the light, in the order of `rays`: t is 0 at the surface and 1 at the
/// light, tmax 0.9999. It starts on the light's side of the triangle.
std::vector<QueryRay> shadowRays(const Mesh& mesh, std::span<const QueryRay> rays,
                                 std::span<const QueryHit> hits, const glm::dvec3& light);

/// For each hit of `hits` one ray of unit direction, cosine-distributed about the triangle's normal on the
/// side that the ray came from, in the order of `rays`; tmax 1e30.
std::vector<QueryRay> diffuseRays(const Mesh& mesh, std::span<const QueryRay> rays,
                                  std::span<const QueryHit> hits);

/// The same rays in an order that has nothing to do with the picture.
std::vector<QueryRay> shuffled(std::vector<QueryRay> rays);

} // namespace rt::bench

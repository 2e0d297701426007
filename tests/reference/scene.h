#pragma once
#include "formats/mesh.h"
#include "tests/reference/optics.h"

#include <embree3/rtcore.h>

#include <optional>

namespace rt::reference {

struct Ray {
    Vec origin, direction; ///< unit length
};

/// What a ray has met, as the material says. Images of base colours count, in full size; others do not.
struct Surface {
    double distance = 0.0;
    std::uint32_t material = 0;
    Vec position;
    Vec face;   ///< unit normal of the triangle, on the ray's side
    Vec normal; ///< the interpolated one, on that side
    bool entering = false;
    Vec color, emission;
    double opacity = 1.0, metallic = 0.0, roughness = 0.0, specular = 0.0, mirror = 0.0, transmission = 0.0;
    bool thin = false, unlit = false;

    bool rough() const { return roughness >= 0.02; }
    /// A place beside the surface, on the side to which `direction` leads.
    Vec leave(const Vec& direction, double gap) const {
        return position + face * (glm::dot(direction, face) >= 0.0 ? gap : -gap);
    }
};

/// A mesh to trace rays through: Embree finds the triangle, double precision where it is hit.
class Scene {
public:
    explicit Scene(const Mesh& mesh);
    ~Scene();
    Scene(const Scene&) = delete;
    Scene& operator=(const Scene&) = delete;

    std::optional<Surface> nearest(const Ray& ray) const;
    const Material& material(std::uint32_t i) const { return mesh_.materials[i]; }
    /// How far from a surface rays start.
    double gap() const { return gap_; }

private:
    Surface surfaceAt(const Ray& ray, std::uint32_t triangle) const;
    void addMaterial(Surface& surface, const glm::uvec3& corners, const Vec& weights) const;

    Mesh mesh_;
    double gap_;
    RTCDevice device_;
    RTCScene scene_;
};

} // namespace rt::reference

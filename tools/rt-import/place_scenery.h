#pragma once
#include "formats/mesh.h"

#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>

namespace rt {

/// Lights and cameras under a transform of the model or scene that they belong to. Lengths take the cube root
/// of its determinant; points and spots become brighter with the square of that, so that what they light
/// looks the same.
Light placed(const Light& light, const glm::dmat4& placement);
NamedCamera placed(const NamedCamera& camera, const glm::dmat4& placement);
CameraKey placed(const CameraKey& key, const glm::dmat4& placement);

/// Sets direction and edges of a rectangle, given from its middle to two edges and the way it faces. A
/// transform may skew it to a parallelogram; the second edge is then set upright, which keeps the area.
void setRectangle(const glm::dvec3& toEdgeU, const glm::dvec3& toEdgeV, const glm::dvec3& facing,
                  const glm::dmat3& linear, Light& light);

} // namespace rt

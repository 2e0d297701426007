#pragma once
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

namespace rt {

// Templates, so that this header needs none of Assimp's.

template <class Vector3>
glm::vec3 vec3Of(const Vector3& v) {
    return {v.x, v.y, v.z};
}

/// Assimp stores rows, GLM columns.
template <class Matrix4x4>
glm::dmat4 mat4Of(const Matrix4x4& m) {
    return {{m.a1, m.b1, m.c1, m.d1},
            {m.a2, m.b2, m.c2, m.d2},
            {m.a3, m.b3, m.c3, m.d3},
            {m.a4, m.b4, m.c4, m.d4}};
}

} // namespace rt

// Lets a .shared.h compile as C++ (inside namespace rt) and as GLSL 4.50.
#ifndef RT_SHARED_TYPES_H
#define RT_SHARED_TYPES_H
#ifdef __cplusplus
#include <cstddef>
#include <cstdint>
#include <glm/common.hpp>
#include <glm/exponential.hpp>
#include <glm/ext/vector_double4.hpp>
#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>
#include <glm/packing.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#define RT_SHARED_BEGIN namespace rt {
#define RT_SHARED_END }
#define RT_SHARED_CONST inline constexpr
#define RT_SHARED_FN inline
namespace rt {
using glm::dvec4;
using glm::ivec3;
using glm::ivec4;
using glm::mat4;
using glm::uvec2;
using glm::uvec3;
using glm::uvec4;
using glm::vec2;
using glm::vec3;
using glm::vec4;
using uint = std::uint32_t;
} // namespace rt
#else
#define RT_SHARED_BEGIN
#define RT_SHARED_END
#define RT_SHARED_CONST const
#define RT_SHARED_FN
#endif
#endif

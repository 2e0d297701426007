#pragma once
#include "common/binary_io.h"
#include "common/bounds.h"
#include "formats/material.shared.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace rt {

/// A decoded 8-bit image: RGBA, straight alpha, top row first.
struct MeshImage {
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    std::uint32_t wrapU = kWrapRepeat;
    std::uint32_t wrapV = kWrapRepeat;
    std::uint64_t firstPixel = 0; ///< index of its first pixel in Mesh::pixels
    std::uint32_t space = kImageSrgb;
    std::uint32_t zero = 0;
};
static_assert(sizeof(MeshImage) == 32);

inline constexpr std::uint32_t kCameraPerspective = 0;
inline constexpr std::uint32_t kCameraOrthographic = 1;
inline constexpr std::uint32_t kCameraPanorama = 2; ///< 360 by 180 degrees round the eye
inline constexpr std::uint32_t kCameraKinds = 3;    ///< that files hold

/// A camera that a file names, in world space.
struct NamedCamera {
    char name[64]; ///< UTF-8, 0 behind it; not empty, no control characters
    double eye[3];
    double lookAt[3];
    double up[3];         ///< about; not along the view
    double fovDegrees;    ///< perspective: of the picture's height, inside (0, 180)
    double height;        ///< orthographic: of what the picture shows, > 0
    double lensRadius;    ///< >= 0; 0 = everything is sharp
    double focusDistance; ///< > 0 where lensRadius is
    std::uint32_t kind;   ///< kCamera...
    std::uint32_t zero;
};
static_assert(sizeof(NamedCamera) == 176);

/// Where a camera is at one frame of its path; on straight lines between its frames.
struct CameraKey {
    double frame = 0.0;
    glm::dvec3 eye{0.0}; ///< world space, as the next two
    glm::dvec3 lookAt{0.0};
    glm::dvec3 up{0.0, 1.0, 0.0};
    double fovDegrees = 0.0;  ///< perspective: of the picture's height, inside (0, 180)
    std::uint32_t camera = 0; ///< index of the scene's camera
    std::uint32_t zero = 0;
};
static_assert(sizeof(CameraKey) == 96);

/// What is seen behind the scene.
struct Surroundings {
    float background[3]{};           ///< radiance, >= 0, where there is no environment
    std::uint32_t hasBackground = 0; ///< 1 = it is stated
    float strength = 1.0f;           ///< >= 0; multiplies the environment's radiance
    float turnDegrees = 0.0f;        ///< of the environment, about +y
    std::uint32_t width = 0;         ///< of the environment's picture; 0 = there is none
    std::uint32_t height = 0;
};
static_assert(sizeof(Surroundings) == 32);

/// An indexed triangle mesh in world space, with all that is needed to shade it.
/// Triangles stand in the imported file's order; a triangle's position is its id everywhere.
struct Mesh {
    SharedSpan<glm::vec3> positions;  ///< one per vertex, world units, finite
    SharedSpan<glm::vec3> normals;    ///< one per vertex, unit length
    SharedSpan<glm::vec2> texcoords;  ///< one per vertex, or none at all; v = 0 is an image's bottom edge
    SharedSpan<glm::uvec3> triangles; ///< three vertex indices each, counter-clockwise from outside
    SharedSpan<std::uint32_t> triangleMaterial; ///< one per triangle: index into materials
    SharedSpan<Material> materials;             ///< at least one
    SharedSpan<Light> lights;                   ///< may be empty
    SharedSpan<NamedCamera> cameras;            ///< may be empty; names are unique
    SharedSpan<MeshImage> images;
    SharedSpan<std::uint32_t> pixels;      ///< of all images; R in the lowest byte
    SharedSpan<CameraKey> cameraKeys;      ///< ascending by camera and frame
    SharedSpan<Surroundings> surroundings; ///< one or none
    SharedSpan<glm::vec3> environment;     ///< radiance of its picture's pixels, see environment_picture.h
};

/// Bounds of the vertices that triangles use. Empty for a mesh without triangles.
Bounds boundsOf(const Mesh& mesh);

/// Indices of triangles and vertices stay below 2^31.
inline constexpr std::size_t kMaxIndexedCount = 0x7FFFFFFFu;

/// A grey or coloured diffuse surface; every other field says "nothing of that kind".
Material diffuseMaterial(const glm::vec3& baseColor);
/// A light that shines to all sides from a point.
Light pointLight(const glm::vec3& position, const glm::vec3& intensity);

/// Whether every number is in the range that material.shared.h gives, and images are among `imageCount`.
bool isValid(const Material& material, std::size_t imageCount);
bool isValid(const Light& light);
bool isValid(const NamedCamera& camera);
bool haveUniqueNames(std::span<const NamedCamera> cameras);
/// Whether the keys are finite, of one of so many cameras, and in order.
bool areValid(std::span<const CameraKey> keys, std::size_t cameraCount);
/// Whether there is one at most, and as many pixels as it says.
bool areValid(std::span<const Surroundings> surroundings, std::size_t environmentPixels);
/// Whether it is light: finite and not negative.
bool isLight(const glm::vec3& radiance);

/// Throws Error{InvalidContent}, message prefixed by `name`, unless every count, index and number holds what
/// the comments above promise.
void validate(const Mesh& mesh, const std::string& name);

} // namespace rt

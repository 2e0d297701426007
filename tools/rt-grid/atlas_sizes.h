#pragma once
#include "formats/atlas.h"
#include "tools/rt-grid/device_limits.h"

#include <vector>

namespace rt {

/// The numbers that decide how many bytes an atlas has: of one that there is, or a forecast.
struct AtlasSizes {
    glm::uvec3 dims{1u};
    std::uint64_t brickWords = 0;
    std::uint64_t referenceWords = 0; ///< exit boxes included
    std::uint64_t triangles = 0;
    std::uint64_t vertices = 0;
    std::uint64_t texcoords = 0;
    std::uint64_t materials = 0;
    std::uint64_t lights = 0;
    std::uint64_t cameras = 0;
    std::uint64_t cameraKeys = 0;
    std::uint64_t surroundings = 0;
    std::uint64_t environment = 0; ///< pixels
    std::uint64_t images = 0;
    glm::uvec3 pages{0u}; ///< texels of a texture page across and down, and how many pages
};

AtlasSizes sizesOf(const Atlas& atlas);

/// What an atlas takes over from a mesh as it is: of either of them.
template <class Scene>
void setScenery(AtlasSizes& sizes, const Scene& scene) {
    sizes.triangles = scene.triangles.size();
    sizes.materials = scene.materials.size();
    sizes.lights = scene.lights.size();
    sizes.cameras = scene.cameras.size();
    sizes.cameraKeys = scene.cameraKeys.size();
    sizes.surroundings = scene.surroundings.size();
    sizes.environment = scene.environment.size();
}

/// What a section becomes on a GPU; see formats/README.md.
enum class GpuObject { None, UniformBlock, Buffer, Texture3D, TextureArray };

struct SectionSize {
    const char* id;
    std::uint64_t bytes;
    GpuObject object;
    glm::uvec3 extent{0u}; ///< of a texture
};

/// The sections that a file of these sizes has, in its order.
std::vector<SectionSize> sectionsOf(const AtlasSizes& sizes);

std::uint64_t fileBytesOf(const std::vector<SectionSize>& sections);

/// "1 piece", "3 pieces" into which rt-trace divides the section for such a device, or why it cannot.
std::string fitOf(const SectionSize& section, const DeviceLimits& limits);

/// The names of GL objects: "3D texture 82x58x37", "buffer".
std::string nameOf(const SectionSize& section);

} // namespace rt

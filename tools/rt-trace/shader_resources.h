#pragma once
#include "formats/atlas.h"
#include "tools/rt-trace/scene_features.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace rt {

enum class ShaderKind { Render, Query };

/// What the device allows; tests lower the figures to force many small pieces.
struct ResourceLimits {
    std::uint64_t storageBlockBytes = 0; ///< of one storage buffer
    unsigned storageBlocks = 0;          ///< storage buffers in one shader
    unsigned storageBindings = 0;        ///< numbers that storage buffers may be bound to
    unsigned textureSize3D = 0;          ///< voxels along each axis of a 3D texture
    std::uint64_t textureBytes = 0;      ///< of one texture
    unsigned textureUnits = 0;           ///< textures in one shader
};

/// One array of the atlas, split into pages of 2^pageShift elements, each of which fits one storage buffer.
struct PagedArray {
    const char* name; ///< of the GLSL arrays: name0, name1, ...
    const char* type; ///< of an element in GLSL
    const char* load; ///< name of the GLSL function that returns element i
    unsigned elementBytes = 0;
    SharedSpan<std::byte> bytes;
    unsigned pageShift = 0; ///< means nothing where there is one page
    unsigned pageCount = 1;
    unsigned firstBinding = 0;

    /// The bytes of page k; empty for an array without elements.
    std::span<const std::byte> page(unsigned k) const;
};

/// The voxels, split along z into slabs of 2^depthShift layers, each of which fits one 3D texture.
struct VoxelSlabs {
    glm::uvec3 dims{0};
    unsigned depthShift = 0; ///< means nothing where there is one slab
    unsigned count = 1;
    unsigned firstUnit = 0; ///< texture unit of the first slab

    unsigned firstLayer(unsigned slab) const { return count == 1 ? 0 : slab << depthShift; }
    unsigned layers(unsigned slab) const;
};

/// Which buffers and textures a shader variant reads, and where each is bound.
struct ResourcePlan {
    ShaderKind kind = ShaderKind::Render;
    SceneFeatures features;
    std::vector<PagedArray> arrays; ///< views into the atlas, but for what is made of it
    VoxelSlabs voxels;
};

/// Throws Error{LimitExceeded}, message prefixed by `name`, if the device cannot hold the atlas.
ResourcePlan planResources(const Atlas& atlas, const SceneFeatures& features, ShaderKind kind,
                           const ResourceLimits& limits, const std::string& name);

/// GLSL that declares everything in the plan; it stands for shaders/resources.glsl.
std::string resourceText(const ResourcePlan& plan);

} // namespace rt

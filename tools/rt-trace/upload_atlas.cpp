#include "tools/rt-trace/upload_atlas.h"

#include "common/error.h"
#include "formats/gpu_interface.shared.h"

#include <epoxy/gl.h>
#include <fmt/format.h>

#include <algorithm>

namespace rt {
namespace {

GlTexture uploadSlab(UploadRing& ring, const Atlas& atlas, const VoxelSlabs& voxels, unsigned slab) {
    const glm::uvec3 dims(voxels.dims.x, voxels.dims.y, voxels.layers(slab));
    GlTexture texture = createTexture3D(GL_TEXTURE_3D, GL_R32UI, dims.x, dims.y, dims.z);
    const std::size_t layer = std::size_t(dims.x) * dims.y;
    ring.fillTexture(texture, dims, GL_RED_INTEGER, GL_UNSIGNED_INT,
                     atlas.voxels.subspan(voxels.firstLayer(slab) * layer, dims.z * layer));
    return texture;
}

// A variant may have textures without the scene having any; it then needs something to bind.
GlTexture uploadPages(UploadRing& ring, const Atlas& atlas, const GlLimits& limits, const std::string& name) {
    const AtlasInfo& info = atlas.info;
    if (info.pageWidth > limits.textureSize2D || info.pageHeight > limits.textureSize2D ||
        info.pageCount > limits.arrayLayers)
        throw Error(ErrorKind::LimitExceeded,
                    fmt::format("{}: {} texture pages of {}x{}; this device allows {} of {}x{}; use smaller "
                                "or fewer images or another --device",
                                name, info.pageCount, info.pageWidth, info.pageHeight, limits.arrayLayers,
                                limits.textureSize2D, limits.textureSize2D));
    const std::uint64_t bytes = atlas.pages.size_bytes();
    if (bytes > limits.resources.textureBytes)
        throw Error(ErrorKind::LimitExceeded,
                    fmt::format("{}: {} texture pages of {}x{} are {} bytes; this device allows {} bytes a "
                                "texture; use smaller images or another --device",
                                name, info.pageCount, info.pageWidth, info.pageHeight, bytes,
                                limits.resources.textureBytes));
    const unsigned width = std::max(info.pageWidth, 1u);
    const unsigned height = std::max(info.pageHeight, 1u);
    GlTexture texture =
        createTexture3D(GL_TEXTURE_2D_ARRAY, GL_SRGB8_ALPHA8, width, height, std::max(info.pageCount, 1u));
    ring.fillTexture(texture, {width, height, info.pageCount}, GL_RGBA, GL_UNSIGNED_BYTE, atlas.pages);
    return texture;
}

} // namespace

std::uint64_t uploadedBytes(const Atlas& atlas, const ResourcePlan& plan) {
    std::uint64_t bytes = atlas.voxels.size_bytes();
    for (const PagedArray& array : plan.arrays) bytes += array.bytes.size();
    if (plan.kind == ShaderKind::Render) bytes += atlas.materials.size_bytes();
    if (plan.features.hasTextures) bytes += atlas.images.size_bytes() + atlas.pages.size_bytes();
    return bytes;
}

GpuAtlas uploadAtlas(const Atlas& atlas, const ResourcePlan& plan, const GlLimits& limits,
                     unsigned lightCount, const std::string& name, std::size_t pieceBytes) {
    UploadRing ring(pieceBytes);
    GpuAtlas gpu;
    GridParams grid = atlas.grid;
    grid.counts.w = lightCount;
    gpu.grid_ = createBuffer(std::as_bytes(std::span(&grid, 1)));
    for (unsigned k = 0; k < plan.voxels.count; ++k)
        gpu.textures_.emplace_back(plan.voxels.firstUnit + k, uploadSlab(ring, atlas, plan.voxels, k));
    for (const PagedArray& array : plan.arrays)
        for (unsigned k = 0; k < array.pageCount; ++k)
            gpu.buffers_.emplace_back(array.firstBinding + k, ring.createBuffer(array.page(k)));
    if (plan.kind == ShaderKind::Render)
        gpu.buffers_.emplace_back(RT_BUFFER_MATERIALS, ring.createBuffer(bytesOf<Material>(atlas.materials)));
    if (plan.features.hasTextures) {
        gpu.buffers_.emplace_back(RT_BUFFER_IMAGES, ring.createBuffer(bytesOf<ImagePlace>(atlas.images)));
        gpu.textures_.emplace_back(RT_TEXTURE_PAGES, uploadPages(ring, atlas, limits, name));
        gpu.textures_.emplace_back(RT_TEXTURE_LINEAR_PAGES,
                                   createView(gpu.textures_.back().second, GL_TEXTURE_2D_ARRAY, GL_RGBA8,
                                              std::max(atlas.info.pageCount, 1u)));
    }
    ring.finish();
    return gpu;
}

void GpuAtlas::bind() const {
    glBindBufferBase(GL_UNIFORM_BUFFER, RT_BINDING_GRID, grid_.name());
    for (const auto& [binding, buffer] : buffers_)
        glBindBufferBase(GL_SHADER_STORAGE_BUFFER, binding, buffer.name());
    for (const auto& [unit, texture] : textures_) glBindTextureUnit(unit, texture.name());
    checkGl("binding the atlas");
}

} // namespace rt

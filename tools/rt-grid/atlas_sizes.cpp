#include "tools/rt-grid/atlas_sizes.h"

#include "formats/section_file.h"

#include <fmt/format.h>

#include <algorithm>

namespace rt {
namespace {

std::uint64_t aligned(std::uint64_t bytes) {
    return (bytes + kSectionAlignment - 1) / kSectionAlignment * kSectionAlignment;
}

std::string inPieces(std::uint64_t amount, std::uint64_t most) {
    const std::uint64_t pieces = (amount + most - 1) / most;
    return pieces <= 1 ? "1 piece" : fmt::format("{} pieces", pieces);
}

} // namespace

AtlasSizes sizesOf(const Atlas& atlas) {
    AtlasSizes sizes;
    sizes.dims = glm::uvec3(atlas.grid.dims);
    sizes.brickWords = atlas.bricks.size();
    sizes.referenceWords = atlas.references.size();
    setScenery(sizes, atlas);
    sizes.vertices = atlas.normals.size();
    sizes.texcoords = atlas.texcoords.size();
    sizes.images = atlas.images.size();
    sizes.pages = {atlas.info.pageWidth, atlas.info.pageHeight, atlas.info.pageCount};
    return sizes;
}

std::vector<SectionSize> sectionsOf(const AtlasSizes& sizes) {
    const auto product = [](const glm::uvec3& v) { return std::uint64_t(v.x) * v.y * v.z; };
    std::vector<SectionSize> sections{
        {"INFO", sizeof(AtlasInfo), GpuObject::None},
        {"GRID", sizeof(GridParams), GpuObject::UniformBlock},
        {"VOXL", product(sizes.dims) * sizeof(std::uint32_t), GpuObject::Texture3D, sizes.dims},
        {"BRIK", sizes.brickWords * sizeof(std::uint32_t), GpuObject::Buffer},
        {"REFS", sizes.referenceWords * sizeof(std::uint32_t), GpuObject::Buffer},
        {"TRIS", sizes.triangles * sizeof(TriangleRecord), GpuObject::Buffer},
        {"TVTX", sizes.triangles * sizeof(glm::uvec4), GpuObject::Buffer},
        {"NORM", sizes.vertices * sizeof(std::uint32_t), GpuObject::Buffer},
        {"TEXC", sizes.texcoords * sizeof(glm::vec2), GpuObject::Buffer},
        {"MATL", sizes.materials * sizeof(Material), GpuObject::Buffer},
        {"LITE", sizes.lights * sizeof(Light), GpuObject::None},
        {"CAMS", sizes.cameras * sizeof(NamedCamera), GpuObject::None},
        {"IMGS", sizes.images * sizeof(ImagePlace), GpuObject::Buffer},
        {"TEXP", product(sizes.pages) * sizeof(std::uint32_t), GpuObject::TextureArray, sizes.pages},
        {"PATH", sizes.cameraKeys * sizeof(CameraKey), GpuObject::None},
        {"SURR", sizes.surroundings * sizeof(Surroundings), GpuObject::None},
        {"ENVP", sizes.environment * sizeof(glm::vec3), GpuObject::None}};
    std::erase_if(sections, [](const SectionSize& section) { return section.bytes == 0; });
    return sections;
}

std::uint64_t fileBytesOf(const std::vector<SectionSize>& sections) {
    std::uint64_t bytes = aligned(sizeof(FileHeader) + sections.size() * sizeof(SectionEntry));
    for (const SectionSize& section : sections) bytes += aligned(section.bytes);
    return bytes;
}

std::string fitOf(const SectionSize& section, const DeviceLimits& limits) {
    const glm::uvec3& extent = section.extent;
    switch (section.object) {
    case GpuObject::Buffer:
        return inPieces(section.bytes, limits.bufferBytes);
    case GpuObject::Texture3D: { // slabs of z
        if (std::max(extent.x, extent.y) > limits.textureSide3D) return "too wide";
        const std::uint64_t slice = section.bytes / extent.z;
        const std::uint64_t slices =
            std::min<std::uint64_t>(limits.textureSide3D, limits.textureBytes / slice);
        return slices == 0 ? "too wide" : inPieces(extent.z, slices);
    }
    case GpuObject::TextureArray:
        if (std::max(extent.x, extent.y) > limits.textureSide2D) return "too wide";
        return extent.z > limits.arrayLayers || section.bytes > limits.textureBytes ? "too many" : "1 piece";
    case GpuObject::UniformBlock:
    case GpuObject::None:
        break;
    }
    return "";
}

std::string nameOf(const SectionSize& section) {
    const glm::uvec3& e = section.extent;
    switch (section.object) {
    case GpuObject::UniformBlock:
        return "uniform block";
    case GpuObject::Buffer:
        return "buffer";
    case GpuObject::Texture3D:
        return fmt::format("3D texture {}x{}x{}", e.x, e.y, e.z);
    case GpuObject::TextureArray:
        return fmt::format("2D array {}x{}x{}", e.x, e.y, e.z);
    case GpuObject::None:
        break;
    }
    return "none";
}

} // namespace rt

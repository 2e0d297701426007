#include "tools/rt-trace/shader_resources.h"

#include "common/error.h"
#include "formats/gpu_interface.shared.h"
#include "tools/rt-trace/slot_layout.h"
#include "tools/rt-trace/triangle_transforms.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <memory>
#include <utility>

namespace rt {
namespace {

template <class T>
PagedArray arrayOf(const char* name, const char* type, const char* load, const SharedSpan<T>& values) {
    return {name, type, load, sizeof(T), {bytesOf<T>(values), nullptr}};
}

template <class Transform>
PagedArray transformArray(const char* type, std::vector<Transform> values) {
    const auto transforms = std::make_shared<std::vector<Transform>>(std::move(values));
    return {"transforms",
            type,
            "loadTransform",
            sizeof(Transform),
            {bytesOf<Transform>(*transforms), transforms}};
}

PagedArray transformArray(const Atlas& atlas, bool doublePrecision) {
    if (doublePrecision)
        return transformArray("TriangleTransformDouble", triangleTransformsDouble(atlas.triangles));
    return transformArray("TriangleTransform", triangleTransforms(atlas.triangles));
}

// The order gives the bindings.
std::vector<PagedArray> wantedArrays(const Atlas& atlas, const SceneFeatures& features, ShaderKind kind) {
    std::vector<PagedArray> arrays = {arrayOf("references", "uint", "loadReference", atlas.references)};
    const bool transformed = features.intersect == kIntersectBaldwinWeber;
    if (transformed) arrays.push_back(transformArray(atlas, features.doublePrecision != 0));
    if (!transformed || kind == ShaderKind::Render)
        arrays.push_back(arrayOf("triangles", "TriangleRecord", "loadTriangle", atlas.triangles));
    if (features.structure == kStructureNested)
        arrays.push_back(arrayOf("bricks", "uint", "loadBrick", atlas.bricks));
    if (kind == ShaderKind::Query) return arrays;
    arrays.push_back(arrayOf("triangleVertices", "uvec4", "loadTriangleVertices", atlas.triangleVertices));
    arrays.push_back(arrayOf("normals", "uint", "loadNormal", atlas.normals));
    if (features.hasTextures) arrays.push_back(arrayOf("texcoords", "vec2", "loadTexcoord", atlas.texcoords));
    return arrays;
}

// Storage buffers that the variant reads besides the arrays' pages.
unsigned unpagedBuffers(const SceneFeatures& features, ShaderKind kind) {
    if (kind == ShaderKind::Query) return 2 + features.countWork + features.scatteredRays; // rays, hits
    return 4 + features.hasTextures + features.hasEnvironment; // materials, lights, slots, rounds
}

// log2 of the most elements, a power of two, that `most` holds.
unsigned shiftFor(std::uint64_t most) {
    return static_cast<unsigned>(std::bit_width(std::max<std::uint64_t>(most, 1)) - 1);
}

void splitArrays(ResourcePlan& plan, const ResourceLimits& limits, const std::string& name) {
    unsigned binding = RT_BUFFER_FIRST_PAGED;
    unsigned buffers = unpagedBuffers(plan.features, plan.kind);
    for (PagedArray& array : plan.arrays) {
        const std::uint64_t count = array.bytes.size() / array.elementBytes;
        array.firstBinding = binding;
        if (array.bytes.size() > limits.storageBlockBytes) {
            array.pageShift = shiftFor(limits.storageBlockBytes / array.elementBytes);
            array.pageCount = static_cast<unsigned>(((count - 1) >> array.pageShift) + 1);
        }
        binding += array.pageCount;
        buffers += array.pageCount;
    }
    if (buffers > limits.storageBlocks || binding > limits.storageBindings)
        throw Error(
            ErrorKind::LimitExceeded,
            fmt::format("{}: needs {} storage buffers of {} bytes; this device allows {}; lower rt-grid's "
                        "--resolution or use another --device",
                        name, buffers, limits.storageBlockBytes,
                        std::min(limits.storageBlocks, limits.storageBindings)));
}

void splitVoxels(ResourcePlan& plan, const ResourceLimits& limits, const std::string& name) {
    VoxelSlabs& voxels = plan.voxels;
    const std::uint64_t layerBytes = std::uint64_t(voxels.dims.x) * voxels.dims.y * sizeof(std::uint32_t);
    const auto fail = [&](const std::string& limit) {
        throw Error(ErrorKind::LimitExceeded,
                    fmt::format("{}: a grid of {}x{}x{} voxels; {}; lower rt-grid's --resolution", name,
                                voxels.dims.x, voxels.dims.y, voxels.dims.z, limit));
    };
    if (voxels.dims.x > limits.textureSize3D || voxels.dims.y > limits.textureSize3D)
        fail(fmt::format("this device allows {} along x and y", limits.textureSize3D));
    if (layerBytes > limits.textureBytes)
        fail(fmt::format("this device allows {} bytes a layer", limits.textureBytes));
    const std::uint64_t mostLayers =
        std::min<std::uint64_t>(limits.textureSize3D, limits.textureBytes / layerBytes);
    if (voxels.dims.z > mostLayers) {
        voxels.depthShift = shiftFor(mostLayers);
        voxels.count = ((voxels.dims.z - 1) >> voxels.depthShift) + 1;
    }
    voxels.firstUnit =
        plan.features.multipass ? RT_TEXTURE_FIRST_RAYS + kRayTextureCount : RT_TEXTURE_FIRST_VOXELS;
    if (voxels.count + voxels.firstUnit > limits.textureUnits)
        fail(fmt::format("it needs {} textures, this device allows {}", voxels.count,
                         limits.textureUnits - voxels.firstUnit));
}

// `TYPE load(ARGUMENT)`: a plain read of piece 0, or a switch over the pieces.
std::string loadFunction(const std::string& signature, unsigned count, const std::string& selector,
                         const std::string& read) {
    const auto readOf = [&](unsigned k) { return fmt::format(fmt::runtime(read), k); };
    if (count == 1) return fmt::format("{} {{\n    return {};\n}}\n", signature, readOf(0));
    std::string text = fmt::format("{} {{\n    switch ({}) {{\n", signature, selector);
    for (unsigned k = 0; k + 1 < count; ++k) text += fmt::format("    case {}: return {};\n", k, readOf(k));
    return text + fmt::format("    default: return {};\n    }}\n}}\n", readOf(count - 1));
}

std::string arrayText(const PagedArray& array) {
    std::string text;
    for (unsigned k = 0; k < array.pageCount; ++k)
        text += fmt::format(
            "layout(std430, binding = {1}) readonly restrict buffer {0}Block{2} {{ {3} {0}{2}[]; }};\n",
            array.name, array.firstBinding + k, k, array.type);
    const bool whole = array.pageCount == 1;
    const std::string index = whole ? "i" : fmt::format("i & {}u", (std::uint64_t(1) << array.pageShift) - 1);
    return text + loadFunction(fmt::format("{} {}(uint i)", array.type, array.load), array.pageCount,
                               fmt::format("int(i >> {})", array.pageShift),
                               fmt::format("{}{{}}[{}]", array.name, index));
}

std::string voxelText(const VoxelSlabs& voxels) {
    std::string text;
    for (unsigned k = 0; k < voxels.count; ++k)
        text += fmt::format("layout(binding = {}) uniform usampler3D voxels{};\n", voxels.firstUnit + k, k);
    const std::string place =
        voxels.count == 1 ? "c" : fmt::format("ivec3(c.xy, c.z & {})", (1u << voxels.depthShift) - 1);
    return text + loadFunction("uint loadVoxel(ivec3 c)", voxels.count,
                               fmt::format("c.z >> {}", voxels.depthShift),
                               fmt::format("texelFetch(voxels{{}}, {}, 0).x", place));
}

std::string uniformText(int binding, const char* type, const char* block, const char* name) {
    return fmt::format("layout(std140, binding = {}) uniform {} {{ {} {}; }};\n", binding, block, type, name);
}

std::string bufferText(int binding, const char* access, const char* type, const char* name) {
    return fmt::format("layout(std430, binding = {}) {} restrict buffer {}Block {{ {} {}[]; }};\n", binding,
                       access, name, type, name);
}

std::string imageText(int unit, const char* format, const char* access, const char* type, const char* name) {
    return fmt::format("layout({}, binding = {}) {} restrict uniform {} {};\n", format, unit, access, type,
                       name);
}

std::string queryText(const SceneFeatures& features) {
    std::string text = uniformText(RT_BINDING_QUERY, "QueryParams", "QueryBlock", "query") +
                       bufferText(RT_BUFFER_RAYS, "readonly", "QueryRay", "rays") +
                       bufferText(RT_BUFFER_HITS, "writeonly",
                                  features.doublePrecision ? "QueryHitDouble" : "QueryHit", "hits");
    if (features.scatteredRays)
        text += fmt::format("layout(std430, binding = {}) restrict buffer QueueBlock {{ uint nextRay; }};\n",
                            RT_BUFFER_QUEUE);
    if (features.countWork) text += bufferText(RT_BUFFER_COUNTERS, "writeonly", "uvec4", "counters");
    return text;
}

// The textures of RayPasses, in the order of their units.
std::string rayTexturesText() {
    std::string text;
    unsigned unit = RT_TEXTURE_FIRST_RAYS;
    for (const char* name : {"color", "origin", "direction", "progress", "hit"})
        text += fmt::format("layout(binding = {}) uniform usampler2D {}Texture;\n", unit++, name);
    return text;
}

std::string renderText(const SceneFeatures& features) {
    std::string text = uniformText(RT_BINDING_CAMERA, "CameraParams", "CameraBlock", "camera") +
                       uniformText(RT_BINDING_RENDER, "RenderParams", "RenderBlock", "picture") +
                       bufferText(RT_BUFFER_MATERIALS, "readonly", "Material", "materials") +
                       bufferText(RT_BUFFER_LIGHTS, "readonly", "Light", "lights") +
                       imageText(RT_IMAGE_COLOR, "rgba32f", "", "image2D", "colorImage") +
                       imageText(RT_IMAGE_SURFACE, "rgba32f", "writeonly", "image2D", "surfaceImage") +
                       imageText(RT_IMAGE_ID, "r32ui", "writeonly", "uimage2D", "idImage") +
                       slotText(slotLayout(features));
    if (features.hasTextures)
        text += bufferText(RT_BUFFER_IMAGES, "readonly", "ImagePlace", "images") +
                fmt::format("layout(binding = {}) uniform sampler2DArray texturePages;\n", RT_TEXTURE_PAGES) +
                fmt::format("layout(binding = {}) uniform sampler2DArray linearPages;\n",
                            RT_TEXTURE_LINEAR_PAGES);
    if (features.hasEnvironment)
        text +=
            bufferText(RT_BUFFER_ENVIRONMENT, "readonly", "float", "environmentTable") +
            fmt::format("layout(binding = {}) uniform sampler2D environmentMap;\n", RT_TEXTURE_ENVIRONMENT);
    if (features.multipass) text += rayTexturesText();
    if (features.countWork) text += imageText(RT_IMAGE_COUNTERS, "rgba32ui", "", "uimage2D", "counterImage");
    if (features.hasMoments) text += imageText(RT_IMAGE_MOMENTS, "rg32f", "", "image2D", "momentImage");
    if (features.hasAovs)
        text += imageText(RT_IMAGE_ALBEDO, "rgba32f", "", "image2D", "albedoImage") +
                imageText(RT_IMAGE_POSITION, "rgba32f", "writeonly", "image2D", "positionImage") +
                imageText(RT_IMAGE_TEXCOORD, "rgba32f", "", "image2D", "texcoordImage");
    return text;
}

} // namespace

std::span<const std::byte> PagedArray::page(unsigned k) const {
    if (pageCount == 1) return bytes;
    const std::size_t pageBytes = std::size_t(elementBytes) << pageShift;
    const std::size_t first = k * pageBytes;
    return bytes.subspan(first, std::min(pageBytes, bytes.size() - first));
}

unsigned VoxelSlabs::layers(unsigned slab) const {
    return count == 1 ? dims.z : std::min(1u << depthShift, dims.z - firstLayer(slab));
}

ResourcePlan planResources(const Atlas& atlas, const SceneFeatures& features, ShaderKind kind,
                           const ResourceLimits& limits, const std::string& name) {
    ResourcePlan plan{kind, features, wantedArrays(atlas, features, kind), {glm::uvec3(atlas.grid.dims)}};
    splitArrays(plan, limits, name);
    splitVoxels(plan, limits, name);
    return plan;
}

std::string resourceText(const ResourcePlan& plan) {
    std::string text =
        uniformText(RT_BINDING_GRID, "GridParams", "GridBlock", "grid") + voxelText(plan.voxels);
    for (const PagedArray& array : plan.arrays) text += arrayText(array);
    return text + (plan.kind == ShaderKind::Query ? queryText(plan.features) : renderText(plan.features));
}

} // namespace rt

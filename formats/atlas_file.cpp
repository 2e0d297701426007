#include "formats/atlas_file.h"

#include "common/error.h"
#include "formats/mesh.h"
#include "formats/parallel_check.h"
#include "formats/section_file.h"

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <vector>

namespace rt {
namespace {

constexpr std::uint32_t kInfo = sectionId("INFO");
constexpr std::uint32_t kGrid = sectionId("GRID");
constexpr std::uint32_t kVoxels = sectionId("VOXL");
constexpr std::uint32_t kBricks = sectionId("BRIK");
constexpr std::uint32_t kReferences = sectionId("REFS");
constexpr std::uint32_t kTriangles = sectionId("TRIS");
constexpr std::uint32_t kTriangleVertices = sectionId("TVTX");
constexpr std::uint32_t kNormals = sectionId("NORM");
constexpr std::uint32_t kTexcoords = sectionId("TEXC");
constexpr std::uint32_t kMaterials = sectionId("MATL");
constexpr std::uint32_t kLights = sectionId("LITE");
constexpr std::uint32_t kCameras = sectionId("CAMS");
constexpr std::uint32_t kImages = sectionId("IMGS");
constexpr std::uint32_t kPages = sectionId("TEXP");
constexpr std::uint32_t kCameraKeys = sectionId("PATH");
constexpr std::uint32_t kSurroundings = sectionId("SURR");
constexpr std::uint32_t kEnvironment = sectionId("ENVP");

class Validator {
public:
    explicit Validator(const std::string& name) : name_(name) {}

    void require(bool holds, const char* what) const {
        if (!holds) throw Error(ErrorKind::InvalidContent, fmt::format("{}: {}", name_, what));
    }
    template <class T, class Predicate>
    void requireEach(const SharedSpan<T>& values, const char* what, const Predicate& holds) const {
        rt::requireEach<T>(values, name_, what, holds);
    }

private:
    const std::string& name_;
};

bool finite3(const glm::vec4& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

bool isPowerOfTwo(float x) {
    int exponent = 0;
    return std::isfinite(x) && x > 0.0f && std::frexp(x, &exponent) == 0.5f;
}

constexpr std::uint32_t kFreeBoxEnd = 1u << 30; // six extents of 5 bits; the tag of an empty voxel

void validateGrid(const Atlas& atlas, const Validator& check) {
    const GridParams& grid = atlas.grid;
    check.require(grid.dims.w <= kStructureNested, "unknown structure kind");
    check.require(atlas.bricks.empty() || grid.dims.w == kStructureNested, "has bricks but is not nested");
    for (int axis = 0; axis < 3; ++axis) {
        check.require(grid.dims[axis] >= 1 && grid.dims[axis] <= (1u << 16), "grid dimensions out of range");
        check.require(grid.cellSize[axis] > 0.0f && std::isfinite(grid.cellSize[axis]),
                      "voxel size out of range");
        check.require(grid.cellsPerUnit[axis] > 0.0f && std::isfinite(grid.cellsPerUnit[axis]),
                      "voxel size out of range");
        check.require(std::abs(grid.cellSize[axis] * grid.cellsPerUnit[axis] - 1.0f) < 1e-5f,
                      "voxel size and its inverse do not agree");
        check.require(std::isfinite(atlas.info.worldLo[axis]) && std::isfinite(atlas.info.worldHi[axis]),
                      "scene bounds are not finite");
    }
    check.require(finite3(grid.gridLo) && finite3(grid.worldOffset), "grid position is not finite");
    check.require(isPowerOfTwo(grid.worldOffset.w), "scale is not a power of two");
    check.require(atlas.voxels.size() == atlas.voxelCount(),
                  "number of voxels is not the product of the dimensions");
}

// Lists stand one after the other in REFS: after the last entry of one begins the next.
void validateLists(const Atlas& atlas, const Validator& check) {
    const auto& refs = atlas.references;
    check.require(refs.empty() || (refs.back() & kLastInList), "a triangle list overruns its section");
    const std::uint32_t* const first = refs.data();
    const auto triangleCount = static_cast<std::uint32_t>(atlas.triangles.size());
    check.requireEach(refs, "list word", [=](const std::uint32_t& word) {
        const std::uint32_t before = &word == first ? kLastInList : *(&word - 1);
        const std::uint32_t ignored = ~before & kLastInList; // the mark of an entry; a list's start has none
        // Bits instead of a branch: where lists start is hard to predict.
        return (word & ~ignored) < (ignored ? triangleCount : kFreeBoxEnd);
    });
}

struct EmptyWords {
    std::uint32_t least, most;
};

EmptyWords emptyWords(const GridParams& grid) {
    if (grid.dims.w == kStructureUniform) return {0, 0};
    if (grid.dims.w == kStructureCloud) // no leap is longer than the grid
        return {1, glm::max(grid.dims.x, glm::max(grid.dims.y, grid.dims.z))};
    return {0, kFreeBoxEnd - 1};
}

// With lists and bricks in order, no voxel that holds leads a shader out of VOXL, BRIK, REFS or TRIS.
void validateVoxels(const Atlas& atlas, const Validator& check) {
    const EmptyWords empty = emptyWords(atlas.grid);
    const bool nested = atlas.grid.dims.w == kStructureNested;
    const std::span<const std::uint32_t> refs = atlas.references;
    const auto holds = [=](std::uint32_t word) {
        if (!(word & kOccupiedBit)) return word >= empty.least && word <= empty.most;
        if (isBrick(word)) return nested; // and requireBricksInOrder() follows it
        const std::uint32_t list = leafList(word);
        return list < refs.size() && (list == 0 || (refs[list - 1] & kLastInList));
    };
    check.requireEach(atlas.voxels, "voxel", holds);
    check.requireEach(atlas.bricks, "brick word", holds);
}

void validateShadingSizes(const Atlas& atlas, const Validator& check) {
    check.require(atlas.triangleVertices.size() == atlas.triangles.size(),
                  "triangle counts of TRIS and TVTX differ");
    check.require(atlas.texcoords.empty() || atlas.texcoords.size() == atlas.normals.size(),
                  "wrong number of texture coordinates");
    const AtlasInfo& info = atlas.info;
    const std::uint64_t pageTexels = std::uint64_t(info.pageWidth) * info.pageHeight;
    check.require(pageTexels == 0 ? atlas.pages.empty() && info.pageCount == 0
                                  : atlas.pages.size() % pageTexels == 0 &&
                                        atlas.pages.size() / pageTexels == info.pageCount,
                  "number of texels is not that of the texture pages");
    check.require(areValid(atlas.surroundings, atlas.environment.size()),
                  "background or environment out of range");
}

void validateShading(const Atlas& atlas, const Validator& check) {
    const std::size_t vertexCount = atlas.normals.size();
    check.requireEach(atlas.triangles, "triangle", [&](const TriangleRecord& t) {
        const auto index = static_cast<std::size_t>(&t - atlas.triangles.data());
        return finite3(t.v0) && finite3(t.v1) && finite3(t.v2) &&
               std::bit_cast<std::uint32_t>(t.v0.w) == index && (t.v1.w == 0.0f || t.v1.w == 1.0f);
    });
    check.requireEach(atlas.triangleVertices, "triangle", [&](const glm::uvec4& t) {
        return t.x < vertexCount && t.y < vertexCount && t.z < vertexCount && t.w < atlas.materials.size();
    });
    check.requireEach(atlas.texcoords, "texture coordinate",
                      [](const glm::vec2& t) { return std::isfinite(t.x) && std::isfinite(t.y); });
    check.requireEach(atlas.materials, "material", [&](const Material& m) {
        return isValid(m, atlas.texcoords.empty() ? 0 : atlas.images.size());
    });
    check.requireEach(atlas.lights, "light", [](const Light& l) { return isValid(l); });
    check.requireEach(atlas.cameras, "camera", [](const NamedCamera& c) { return isValid(c); });
    check.require(haveUniqueNames(atlas.cameras), "two cameras have one name");
    check.require(areValid(atlas.cameraKeys, atlas.cameras.size()),
                  "a camera's path is out of range or order");
    check.requireEach(atlas.environment, "environment pixel", isLight);
    const AtlasInfo& info = atlas.info;
    check.requireEach(atlas.images, "image", [&](const ImagePlace& image) {
        const glm::uvec2 extent = extentWithLevels(image.rect.z, image.rect.w);
        return image.rect.z >= 1 && image.rect.w >= 1 &&
               std::uint64_t(image.rect.x) + extent.x <= info.pageWidth &&
               std::uint64_t(image.rect.y) + extent.y <= info.pageHeight && image.page.x < info.pageCount &&
               image.page.y <= kWrapMirror && image.page.z <= kWrapMirror && image.page.w <= kImageLinear;
    });
}

} // namespace

std::string structureName(std::uint32_t structure) {
    static constexpr const char* kNames[] = {"uniform", "cloud", "octant", "nested"};
    return structure < std::size(kNames) ? kNames[structure] : "unknown";
}

void validateSizes(const Atlas& atlas, const std::string& name) {
    const Validator check(name);
    check.require(atlas.triangles.size() <= kMaxIndexedCount && atlas.normals.size() <= kMaxIndexedCount &&
                      atlas.materials.size() <= kMaxIndexedCount && atlas.lights.size() <= kMaxIndexedCount,
                  "more triangles, vertices, materials or lights than 31 bits count");
    check.require(atlas.grid.counts == glm::uvec4(atlas.triangles.size(), atlas.normals.size(),
                                                  atlas.materials.size(), atlas.lights.size()),
                  "counts in GRID differ from the sections' sizes");
    check.require(!atlas.triangles.empty() && !atlas.materials.empty(), "has no triangles or no materials");
    validateGrid(atlas, check);
    validateShadingSizes(atlas, check);
}

void validate(const Atlas& atlas, const std::string& name) {
    validateSizes(atlas, name);
    const Validator check(name);
    checkTogether({[&] { validateLists(atlas, check); },
                   [&] {
                       if (atlas.grid.dims.w == kStructureNested) requireBricksInOrder(atlas, name);
                   },
                   [&] { validateVoxels(atlas, check); }, [&] { validateShading(atlas, check); }});
}

void writeAtlas(const std::string& path, const Atlas& atlas, const Recipe& recipe) {
    SectionFileWriter writer(kAtlasKind);
    writer.add<AtlasInfo>(kInfo, std::span(&atlas.info, 1));
    writer.add<GridParams>(kGrid, std::span(&atlas.grid, 1));
    writer.add<std::uint32_t>(kVoxels, atlas.voxels);
    if (!atlas.bricks.empty()) writer.add<std::uint32_t>(kBricks, atlas.bricks);
    writer.add<std::uint32_t>(kReferences, atlas.references);
    writer.add<TriangleRecord>(kTriangles, atlas.triangles);
    writer.add<glm::uvec4>(kTriangleVertices, atlas.triangleVertices);
    writer.add<std::uint32_t>(kNormals, atlas.normals);
    if (!atlas.texcoords.empty()) writer.add<glm::vec2>(kTexcoords, atlas.texcoords);
    writer.add<Material>(kMaterials, atlas.materials);
    if (!atlas.lights.empty()) writer.add<Light>(kLights, atlas.lights);
    if (!atlas.cameras.empty()) writer.add<NamedCamera>(kCameras, atlas.cameras);
    if (!atlas.images.empty()) {
        writer.add<ImagePlace>(kImages, atlas.images);
        writer.add<std::uint32_t>(kPages, atlas.pages);
    }
    if (!atlas.cameraKeys.empty()) writer.add<CameraKey>(kCameraKeys, atlas.cameraKeys);
    if (!atlas.surroundings.empty()) writer.add<Surroundings>(kSurroundings, atlas.surroundings);
    if (!atlas.environment.empty()) writer.add<glm::vec3>(kEnvironment, atlas.environment);
    writer.addRecipe(recipe.text());
    writer.write(path);
}

MappedAtlas::MappedAtlas(const std::string& path)
    : path_(path),
      sections_(std::make_unique<const SectionFile>(path, kAtlasKind)), file_{{},
                                                                              sections_->contentHash(),
                                                                              sections_->fileBytes()} {
    const SectionFile& file = *sections_;
    Atlas& atlas = file_.atlas;
    atlas.info = file.get<AtlasInfo>(kInfo, 1)[0];
    atlas.grid = file.get<GridParams>(kGrid, 1)[0];
    atlas.voxels = file.get<std::uint32_t>(kVoxels);
    atlas.bricks = file.get<std::uint32_t>(kBricks);
    atlas.references = file.get<std::uint32_t>(kReferences);
    atlas.triangles = file.get<TriangleRecord>(kTriangles);
    atlas.triangleVertices = file.get<glm::uvec4>(kTriangleVertices);
    atlas.normals = file.get<std::uint32_t>(kNormals);
    atlas.texcoords = file.get<glm::vec2>(kTexcoords);
    atlas.materials = file.get<Material>(kMaterials);
    atlas.lights = file.get<Light>(kLights);
    atlas.cameras = file.get<NamedCamera>(kCameras);
    atlas.images = file.get<ImagePlace>(kImages);
    atlas.pages = file.get<std::uint32_t>(kPages);
    atlas.cameraKeys = file.get<CameraKey>(kCameraKeys);
    atlas.surroundings = file.get<Surroundings>(kSurroundings);
    atlas.environment = file.get<glm::vec3>(kEnvironment);
}

MappedAtlas::~MappedAtlas() = default;

void MappedAtlas::verify() const {
    sections_->verify([this] { validate(file_.atlas, path_); });
}

AtlasFile readAtlas(const std::string& path) {
    const MappedAtlas mapped(path);
    mapped.verify();
    return mapped.unverified();
}

} // namespace rt

// What rt-grid inspect says of an atlas, against counts made here.
#include "common/error.h"
#include "formats/atlas_file.h"
#include "formats/heat_color.h"
#include "tests/support/make_mesh.h"
#include "tests/support/split_mix.h"
#include "tests/support/temporary_folder.h"
#include "tools/rt-grid/atlas_figures.h"
#include "tools/rt-grid/atlas_sizes.h"
#include "tools/rt-grid/build_atlas.h"
#include "tools/rt-grid/slice_legend.h"
#include "tools/rt-grid/slices.h"
#include "tools/rt-grid/walk_rays.h"
#include "tools/rt-grid/write_files.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numeric>

namespace rt {
namespace {

constexpr std::array kStructures{kStructureUniform, kStructureCloud, kStructureOctant, kStructureNested};

Atlas build(const Mesh& mesh, std::uint32_t structure, const glm::uvec3& dims = glm::uvec3(0)) {
    BuildOptions options;
    options.structure = structure;
    options.resolution.exact = dims;
    StageTimer timer;
    return buildAtlas(MeshFile{mesh, 77}, "mesh", options, timer).atlas;
}

// One triangle in the middle voxel of 5x5x5.
Atlas oneVoxelOf125() {
    Mesh mesh = test::makeTriangles({{-1, -1, -1},
                                     {-1, -1, -1},
                                     {-1, -1, -1},
                                     {1, 1, 1},
                                     {1, 1, 1},
                                     {1, 1, 1},
                                     {-0.1f, -0.1f, 0},
                                     {0.1f, 0, 0},
                                     {0, 0.1f, 0.1f}});
    return build(mesh, kStructureCloud, {5, 5, 5});
}

TEST(GridInspect, figuresOfASmallGridAreThoseCountedByHand) {
    // Triangles of one point each in two opposite corners, and one in the middle.
    const AtlasFigures figures = figuresOf(oneVoxelOf125());
    ASSERT_EQ(figures.levels.size(), 1u);
    EXPECT_EQ(figures.levels[0].leaves, 3u);
    EXPECT_EQ(figures.levels[0].empty, 122u);
    EXPECT_EQ(figures.levels[0].references, 3u);
    EXPECT_DOUBLE_EQ(figures.occupiedVolume, 3.0 / 125.0);
    // Distance 1: the middle's 26 neighbours, and the corners' 7 each, of which they share one each.
    EXPECT_EQ(figures.distances.counts()[1], 26u + 2u * 6u);
    EXPECT_EQ(figures.distances.largest(), 2u);
    EXPECT_EQ(figures.distances.count(), 122u);
    EXPECT_DOUBLE_EQ(figures.distances.mean(), (38.0 + 2.0 * 84.0) / 122.0);
    EXPECT_EQ(figures.extents.count(), 0u);
    EXPECT_EQ(figures.referencesPerLeaf.counts(), (std::vector<std::uint64_t>{0, 3}));
    EXPECT_EQ(figures.referencesPerTriangle.counts(), (std::vector<std::uint64_t>{0, 3}));
}

TEST(GridInspect, figuresOfAllStructuresAddUp) {
    for (const std::uint32_t structure : kStructures) {
        const Atlas atlas = build(test::makeSphere(4), structure);
        const AtlasFigures figures = figuresOf(atlas);
        std::uint64_t voxels = 0, leaves = 0, references = 0, brickWords = 0;
        for (const LevelFigures& level : figures.levels) {
            voxels += level.voxels();
            leaves += level.leaves;
            references += level.references;
            for (const auto& [side, count] : level.bricks)
                brickWords += count * std::uint64_t(side) * side * side;
        }
        EXPECT_EQ(voxels, atlas.voxels.size() + atlas.bricks.size());
        EXPECT_EQ(brickWords, atlas.bricks.size());
        EXPECT_EQ(leaves, atlas.info.occupiedVoxels);
        EXPECT_EQ(references, atlas.info.references);
        EXPECT_EQ(figures.referencesPerLeaf.count(), leaves);
        EXPECT_EQ(figures.referencesPerTriangle.count(), atlas.triangles.size());
        EXPECT_NEAR(figures.referencesPerTriangle.mean(), double(references) / double(atlas.triangles.size()),
                    1e-9);
        EXPECT_EQ(figures.exits.count(), hasBoxes(structure) ? 6 * leaves : 0);
        EXPECT_EQ(figures.extents.count(), hasBoxes(structure) ? 6 * figures.distances.count() : 0);
        if (structure == kStructureCloud) {
            EXPECT_EQ(figures.distances.largest(), atlas.info.maxDistance);
        }
    }
}

TEST(GridInspect, sectionsAreThoseOfTheFile) {
    const test::TemporaryFolder folder;
    for (const std::uint32_t structure : kStructures)
        for (const Mesh& mesh : {test::makeSphere(2), test::makeTexturedSquare({{5, 9}, {30, 2}})}) {
            const Atlas atlas = build(mesh, structure);
            writeAtlas(folder.file("a.rtatlas"), atlas);
            EXPECT_EQ(fileBytesOf(sectionsOf(sizesOf(atlas))),
                      std::filesystem::file_size(folder.file("a.rtatlas")));
        }
}

TEST(GridInspect, limitsDivideWhatIsTooLarge) {
    const DeviceLimits limits{"small", 1000, 1u << 20, 64, 128, 4};
    const auto fit = [&](GpuObject object, std::uint64_t bytes, const glm::uvec3& extent = glm::uvec3(0)) {
        return fitOf({"TEST", bytes, object, extent}, limits);
    };
    EXPECT_EQ(fit(GpuObject::Buffer, 1000), "1 piece");
    EXPECT_EQ(fit(GpuObject::Buffer, 1001), "2 pieces");
    EXPECT_EQ(fit(GpuObject::Texture3D, 64 * 64 * 64 * 4, {64, 64, 64}), "1 piece");
    EXPECT_EQ(fit(GpuObject::Texture3D, 64 * 64 * 65 * 4, {64, 64, 65}), "2 pieces");
    EXPECT_EQ(fit(GpuObject::Texture3D, 65 * 4, {65, 1, 1}), "too wide");
    EXPECT_EQ(fit(GpuObject::TextureArray, 128 * 128 * 4, {128, 128, 1}), "1 piece");
    EXPECT_EQ(fit(GpuObject::TextureArray, 129 * 4, {129, 1, 1}), "too wide");
    EXPECT_EQ(fit(GpuObject::TextureArray, 5 * 4, {1, 1, 5}), "too many");
    EXPECT_EQ(fit(GpuObject::None, 5000), "");
    EXPECT_EQ(guaranteedLimits().bufferBytes, 1u << 27);
}

// The nearest triangle of all, of which a walk must find the same.
std::uint32_t nearestOfAll(const Atlas& atlas, const glm::dvec3& origin, const glm::dvec3& direction) {
    const glm::dvec3 lo(atlas.grid.gridLo), size(atlas.grid.cellSize);
    std::uint32_t nearest = kNoHit;
    double best = 1e300;
    for (std::uint32_t i = 0; i < atlas.triangles.size(); ++i) {
        const TriangleRecord& t = atlas.triangles[i];
        const glm::dvec3 a = (glm::dvec3(t.v0) - lo) / size, b = (glm::dvec3(t.v1) - lo) / size;
        const glm::dvec3 normal = glm::cross(b - a, (glm::dvec3(t.v2) - lo) / size - a);
        const double distance = glm::dot(a - origin, normal) / glm::dot(direction, normal);
        const glm::dvec3 hit = origin + distance * direction;
        const glm::dvec3 c = (glm::dvec3(t.v2) - lo) / size;
        const bool isInside = glm::dot(glm::cross(b - a, hit - a), normal) >= 0 &&
                              glm::dot(glm::cross(c - b, hit - b), normal) >= 0 &&
                              glm::dot(glm::cross(a - c, hit - c), normal) >= 0;
        if (!isInside || !(distance > 0.0) || distance >= best) continue;
        best = distance;
        nearest = i;
    }
    return nearest;
}

TEST(GridInspect, raysFindTheNearestTriangleInAllStructures) {
    for (const std::uint32_t structure : kStructures) {
        const Atlas atlas = build(test::makeRandomTriangles(300, 4, 0.2f), structure);
        const glm::dvec3 dims(atlas.grid.dims);
        int hits = 0;
        for (std::uint64_t ray = 0; ray < 500; ++ray) {
            test::RayNumbers numbers(3, ray);
            const glm::dvec3 origin = dims * (glm::dvec3(numbers.point()) * 3.0 - 1.0);
            const glm::dvec3 direction = dims * glm::dvec3(numbers.point()) - origin;
            const std::uint32_t found = nearestTriangle(atlas, origin, direction, 0.0);
            EXPECT_EQ(found, nearestOfAll(atlas, origin, direction))
                << structureName(structure) << " " << ray;
            hits += found != kNoHit;
        }
        EXPECT_GT(hits, 100);
        EXPECT_LT(hits, 500);
    }
}

TEST(GridInspect, sampledRaysDoWhatTheyMust) {
    const Mesh mesh = test::makeSphere(4);
    const RaySample uniform = walkRays(build(mesh, kStructureUniform, {40, 40, 40}));
    const RaySample cloud = walkRays(build(mesh, kStructureCloud, {40, 40, 40}));
    // A convex body: the share of lines through the grid's box that meet it is the ratio of the surfaces
    // (Santalo 1976), the box being 24 and 64/62 wider.
    const double boxSurface = 24.0 * std::pow(40.0 / (40.0 - 1.0 / 16.0), 2);
    EXPECT_NEAR(uniform.across.hits, 4.0 * 3.14159265 / boxSurface, 0.02);
    EXPECT_DOUBLE_EQ(uniform.across.hits, cloud.across.hits);
    EXPECT_NEAR(uniform.towards.hits, 1.0, 1e-3);
    EXPECT_NEAR(uniform.from.hits, 0.5, 0.02); // inwards
    EXPECT_LT(cloud.across.steps, 0.6 * uniform.across.steps);
    EXPECT_DOUBLE_EQ(cloud.towards.tests, uniform.towards.tests); // the same voxels with triangles
    // A line through a cube of n voxels crosses n of them on average (4 V / S long, 1.5 voxels per unit), and
    // half of these end at the sphere.
    EXPECT_GT(uniform.across.steps, 0.25 * 40.0);
    EXPECT_LT(uniform.across.steps, 40.0);
}

glm::dvec3 pixelOf(const Image& image, std::uint32_t x, std::uint32_t y) {
    glm::dvec3 color;
    for (int channel = 0; channel < 3; ++channel)
        color[channel] = image.find(std::string(1, "RGB"[channel]))->values[std::size_t(y) * image.width + x];
    return color;
}

bool shows(const Image& image, std::uint32_t x, std::uint32_t y, const glm::dvec3& srgb) {
    const glm::dvec3 found = pixelOf(image, x, y);
    for (int channel = 0; channel < 3; ++channel)
        if (std::abs(found[channel] - decodeSrgb(srgb[channel])) > 1e-5) return false;
    return true;
}

TEST(GridInspect, slicesShowTheVoxelsWhereTheyAre) {
    const Atlas atlas = oneVoxelOf125();
    const std::vector<SlicePicture> slices = slicesOf(atlas, glm::dvec3(0.5));
    ASSERT_EQ(slices.size(), 9u);
    std::vector<std::string> names;
    for (const SlicePicture& slice : slices) names.push_back(slice.name);
    EXPECT_THAT(names, testing::IsSupersetOf({"occupancy_x.png", "distance_y.png", "references_z.png"}));
    const Image& distance = slices[1].image; // 960 pixels for 5 voxels, from (16, 42) on
    const auto centre = [](std::uint32_t voxel) { return voxel * 192 + 96; };
    for (std::uint32_t y = 0; y < 5; ++y)
        for (std::uint32_t x = 0; x < 5; ++x) {
            const bool isMiddle = x == 2 && y == 2;
            const bool isNear = std::max(std::abs(int(x) - 2), std::abs(int(y) - 2)) == 1;
            EXPECT_TRUE(shows(distance, 16 + centre(x), 42 + centre(y),
                              isMiddle ? glm::dvec3(1.0) : heatColor(isNear ? 0.0 : 1.0)))
                << x << " " << y;
        }
    // The corner at the origin is at the bottom left of a cut through it, and that at the far end not in
    // sight.
    const Image occupancy = slicesOf(atlas, glm::dvec3(0.0))[6].image;
    EXPECT_TRUE(shows(occupancy, 16 + centre(0), 42 + centre(4), heatColor(0.5)));
    EXPECT_TRUE(shows(occupancy, 16 + centre(4), 42 + centre(0), glm::dvec3(1.0)));
    EXPECT_EQ(slicesOf(build(test::makeCube(), kStructureUniform, {4, 4, 4}), glm::dvec3(0.5)).size(), 6u);
}

TEST(GridInspect, aLegendSaysWhatColoursMean) {
    const LegendScale scale(1.0, 300.0, true);
    EXPECT_DOUBLE_EQ(scale.part(1.0), 0.0);
    EXPECT_DOUBLE_EQ(scale.part(300.0), 1.0);
    EXPECT_NEAR(scale.part(std::sqrt(300.0)), 0.5, 1e-12);
    EXPECT_EQ(scale.ticks(), (std::vector<double>{1, 2, 4, 8, 16, 32, 64, 128, 256}));
    EXPECT_EQ(LegendScale(0.0, 4.0, false).ticks(), (std::vector<double>{0, 1, 2, 3, 4}));
    EXPECT_EQ(LegendScale(3.0, 3.0, true).ticks(), (std::vector<double>{3}));
    LegendCanvas canvas(100, 50, "title", scale);
    const Image image = canvas.image();
    EXPECT_TRUE(shows(image, 100 + 32 + 12, 42, heatColor(1.0 - 0.5 / 320))); // the top of the bar
    EXPECT_TRUE(shows(image, 100 + 32 + 12, 42 + 319, heatColor(0.5 / 320)));
    std::size_t dark = 0; // the title has ink
    for (std::uint32_t y = 16; y < 34; ++y)
        for (std::uint32_t x = 16; x < 80; ++x) dark += pixelOf(image, x, y).x == 0.0;
    EXPECT_GT(dark, 100u);
}

TEST(GridInspect, aFolderIsWrittenWholeOrNotAtAll) {
    const test::TemporaryFolder folder;
    const std::vector<NamedBytes> files{{"a.png", {std::byte(1)}}, {"no/such.png", {std::byte(2)}}};
    EXPECT_THROW(writeFolder(folder.file("new"), files), Error);
    EXPECT_EQ(folder.entryCount(), 0u);
    writeFolder(folder.file("new"), {files[0]});
    EXPECT_EQ(std::filesystem::file_size(folder.file("new/a.png")), 1u);
    EXPECT_THROW(writeFolder(folder.file("new"), {{"b.png", {}}, files[1]}), Error);
    EXPECT_FALSE(std::filesystem::exists(folder.file("new/b.png")));
    EXPECT_TRUE(std::filesystem::exists(folder.file("new/a.png"))); // was there before
    EXPECT_THROW(requireFolderWritable(folder.file("new/a.png")), Error);
    EXPECT_THROW(requireFolderWritable(folder.file("no/such/folder")), Error);
    EXPECT_NO_THROW(requireFolderWritable(folder.file("other")));
}

} // namespace
} // namespace rt

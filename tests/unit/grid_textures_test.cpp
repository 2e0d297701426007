#include "common/error.h"
#include "tests/support/make_mesh.h"
#include "tools/rt-grid/pack_textures.h"

#include <gtest/gtest.h>

#include <random>

namespace rt {
namespace {

std::vector<glm::uvec2> randomSizes(std::size_t count, unsigned largest, std::uint32_t seed) {
    std::mt19937 random(seed);
    std::vector<glm::uvec2> sizes(count);
    for (glm::uvec2& size : sizes) {
        size.x = 1 + static_cast<unsigned>(random() % largest);
        size.y = 1 + static_cast<unsigned>(random() % largest);
    }
    return sizes;
}

// Every texel of the pages holds the pixel it should: counts those that do not, and what is neither image nor
// empty.
std::size_t wrongTexels(const Mesh& mesh, const PageLayout& layout) {
    const std::vector<std::uint32_t> texels = paintPages(mesh, layout);
    std::vector<std::uint32_t> expected(texels.size(), 0u);
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < mesh.images.size(); ++i) {
        const ImagePlace& place = layout.places[i];
        for (std::uint32_t y = 0; y < mesh.images[i].height; ++y)
            for (std::uint32_t x = 0; x < mesh.images[i].width; ++x) {
                const std::size_t row = std::size_t(place.page.x) * layout.height + place.rect.y + y;
                std::uint32_t& texel = expected[row * layout.width + place.rect.x + x];
                wrong += texel != 0; // two images on one texel
                texel = mesh.pixels[mesh.images[i].firstPixel + y * mesh.images[i].width + x];
            }
    }
    for (std::size_t i = 0; i < texels.size(); ++i) wrong += texels[i] != expected[i];
    return wrong;
}

void expectInside(const Mesh& mesh, const PageLayout& layout) {
    ASSERT_EQ(layout.places.size(), mesh.images.size());
    for (std::size_t i = 0; i < layout.places.size(); ++i) {
        const ImagePlace& place = layout.places[i];
        EXPECT_EQ(place.rect.z, mesh.images[i].width);
        EXPECT_EQ(place.rect.w, mesh.images[i].height);
        EXPECT_LE(place.rect.x + place.rect.z, layout.width);
        EXPECT_LE(place.rect.y + place.rect.w, layout.height);
        EXPECT_LT(place.page.x, layout.pageCount);
        EXPECT_EQ(place.page.y, mesh.images[i].wrapU);
        EXPECT_EQ(place.page.z, mesh.images[i].wrapV);
    }
}

TEST(GridTextures, imagesDoNotOverlapAndKeepTheirPixels) {
    for (const auto& [count, largest] : {std::pair(1, 1), {1, 300}, {17, 200}, {200, 64}, {40, 500}}) {
        const Mesh mesh = test::makeTexturedSquare(
            randomSizes(static_cast<std::size_t>(count), static_cast<unsigned>(largest), 3));
        const PageLayout layout = placeImages(mesh.images, "mesh");
        expectInside(mesh, layout);
        EXPECT_EQ(layout.pageCount, 1u);
        EXPECT_EQ(wrongTexels(mesh, layout), 0u) << count << " images up to " << largest;
    }
}

TEST(GridTextures, usesSeveralPagesWhenOneIsFull) {
    const Mesh mesh = test::makeTexturedSquare({{3000, 2500}, {2000, 1000}, {2500, 2600}, {10, 4000}});
    const PageLayout layout = placeImages(mesh.images, "mesh");
    expectInside(mesh, layout);
    EXPECT_EQ(layout.width, 4096u);
    EXPECT_EQ(layout.height, 4096u);
    EXPECT_EQ(layout.pageCount, 2u);
    EXPECT_EQ(wrongTexels(mesh, layout), 0u);
}

TEST(GridTextures, onePageIsAsSmallAsItCanBe) {
    const std::vector<MeshImage> images(4, MeshImage{256, 256, kWrapRepeat, kWrapRepeat, 0});
    const PageLayout square = placeImages(std::vector<MeshImage>(images), "mesh");
    EXPECT_EQ(glm::uvec2(square.width, square.height), glm::uvec2(512, 512));
    const PageLayout two = placeImages(std::vector<MeshImage>(images.begin(), images.begin() + 2), "mesh");
    EXPECT_EQ(glm::uvec2(two.width, two.height), glm::uvec2(512, 256)); // unused rows are cut
    EXPECT_EQ(placeImages({}, "mesh").texelCount(), 0u);
}

TEST(GridTextures, aLongImageGetsAPageOfItsLength) {
    const PageLayout layout =
        placeImages(std::vector<MeshImage>{{5000, 7, 0, 0, 0}, {300, 300, 0, 0, 0}}, "mesh");
    EXPECT_EQ(layout.width, 8192u);
    EXPECT_EQ(layout.height, 300u);
}

TEST(GridTextures, refusesAnImageThatNoTextureHolds) {
    const std::vector<MeshImage> images{{16385, 1, kWrapRepeat, kWrapRepeat, 0}};
    try {
        placeImages(std::vector<MeshImage>(images), "wide.rtmesh");
        FAIL() << "accepted";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::LimitExceeded);
        EXPECT_NE(std::string(error.what()).find("wide.rtmesh: "), std::string::npos);
    }
}

} // namespace
} // namespace rt

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

std::size_t indexOf(const PageLayout& layout, std::size_t image, const glm::uvec4& rect, std::uint32_t x,
                    std::uint32_t y) {
    const std::size_t row = std::size_t(layout.places[image].page.x) * layout.height + rect.y + y;
    return row * layout.width + rect.x + x;
}

// Every texel of the largest level holds its pixel, no two levels meet, and the rest is empty: counts the
// texels for which that is not so.
std::size_t wrongTexels(const Mesh& mesh, const PageLayout& layout) {
    const std::vector<std::uint32_t> texels = paintPages(mesh, layout);
    std::vector<bool> taken(texels.size(), false);
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < mesh.images.size(); ++i) {
        glm::uvec4 rect(0);
        for (std::uint32_t level = 0; rect.z != 1 || rect.w != 1; ++level) {
            rect = levelRect(layout.places[i].rect, level);
            for (std::uint32_t y = 0; y < rect.w; ++y)
                for (std::uint32_t x = 0; x < rect.z; ++x) {
                    const std::size_t texel = indexOf(layout, i, rect, x, y);
                    wrong += taken[texel] || texels[texel] >> 24 != 255u;
                    taken[texel] = true;
                    if (level == 0)
                        wrong += texels[texel] != mesh.pixels[mesh.images[i].firstPixel + y * rect.z + x];
                }
        }
    }
    for (std::size_t i = 0; i < texels.size(); ++i) wrong += !taken[i] && texels[i] != 0u;
    return wrong;
}

void expectInside(const Mesh& mesh, const PageLayout& layout) {
    ASSERT_EQ(layout.places.size(), mesh.images.size());
    for (std::size_t i = 0; i < layout.places.size(); ++i) {
        const ImagePlace& place = layout.places[i];
        EXPECT_EQ(place.rect.z, mesh.images[i].width);
        EXPECT_EQ(place.rect.w, mesh.images[i].height);
        const glm::uvec2 extent = extentWithLevels(place.rect.z, place.rect.w);
        EXPECT_LE(place.rect.x + extent.x, layout.width);
        EXPECT_LE(place.rect.y + extent.y, layout.height);
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
    const Mesh mesh = test::makeTexturedSquare({{2000, 2500}, {2000, 1000}, {2500, 2600}, {10, 4000}});
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
    EXPECT_EQ(glm::uvec2(square.width, square.height), glm::uvec2(1024, 512)); // each is 384 wide
    const PageLayout two = placeImages(std::vector<MeshImage>(images.begin(), images.begin() + 2), "mesh");
    EXPECT_EQ(glm::uvec2(two.width, two.height), glm::uvec2(512, 512));
    const PageLayout one = placeImages(std::vector<MeshImage>(images.begin(), images.begin() + 1), "mesh");
    EXPECT_EQ(glm::uvec2(one.width, one.height), glm::uvec2(512, 256)); // unused rows are cut
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

// One image with its levels, on a page of its own.
struct Painted {
    PageLayout layout;
    std::vector<std::uint32_t> texels;

    std::vector<std::uint32_t> level(std::uint32_t k) const {
        const glm::uvec4 rect = levelRect(layout.places[0].rect, k);
        std::vector<std::uint32_t> result;
        for (std::uint32_t y = 0; y < rect.w; ++y)
            for (std::uint32_t x = 0; x < rect.z; ++x)
                result.push_back(texels[indexOf(layout, 0, rect, x, y)]);
        return result;
    }
};

Painted paint(glm::uvec2 size, std::vector<std::uint32_t> pixels, std::uint32_t space = kImageSrgb) {
    Mesh mesh;
    mesh.images = std::vector<MeshImage>{{size.x, size.y, kWrapRepeat, kWrapRepeat, 0, space, 0}};
    mesh.pixels = std::move(pixels);
    PageLayout layout = placeImages(mesh.images, "mesh");
    std::vector<std::uint32_t> texels = paintPages(mesh, layout);
    return {std::move(layout), std::move(texels)};
}

TEST(GridTextureLevels, aCheckerBecomesTheGreyOfHalfTheLight) {
    const std::vector<std::uint32_t> checker{0xFF000000u, 0xFFFFFFFFu, 0xFFFFFFFFu, 0xFF000000u};
    EXPECT_EQ(paint({2, 2}, checker).level(1), std::vector{0xFFBCBCBCu}); // 0.5 is sRGB 187.5
    EXPECT_EQ(paint({2, 2}, checker, kImageLinear).level(1), std::vector{0xFF808080u});
}

TEST(GridTextureLevels, clearTexelsDoNotTingeWhatIsSeen) {
    const std::vector<std::uint32_t> redBesideClearGreen{0xFF0000FFu, 0x0000FF00u};
    EXPECT_EQ(paint({2, 1}, redBesideClearGreen).level(1), std::vector{0x800000FFu});
    EXPECT_EQ(paint({2, 1}, redBesideClearGreen, kImageLinear).level(1), std::vector{0x80008080u});
    const std::vector<std::uint32_t> allClear{0x000000FFu, 0x000000FFu};
    EXPECT_EQ(paint({2, 1}, allClear).level(1), std::vector{0x000000FFu}); // keeps its colour, not black
}

TEST(GridTextureLevels, oddSidesCountEachTexelByTheAreaThatIsCovered) {
    // 5 -> 2: texels cover 2.5 each; 3 -> 1: all of them.
    std::vector<std::uint32_t> pixels;
    for (std::uint32_t y = 0; y < 3; ++y)
        for (std::uint32_t x = 0; x < 5; ++x) pixels.push_back(0xFF000000u + 50 * x + ((10 * y) << 8));
    const Painted painted = paint({5, 3}, pixels, kImageLinear);
    EXPECT_EQ(painted.level(1), (std::vector{0xFF000A28u, 0xFF000AA0u})); // (0 + 50 + 100/2) / 2.5 = 40
    EXPECT_EQ(painted.level(2), std::vector{0xFF000A64u});
}

TEST(GridTextureLevels, aSingleRowOrColumnShrinksAlongItsLength) {
    const std::vector<std::uint32_t> row{0xFF000000u, 0xFF000002u, 0xFF000004u, 0xFF00000Au, 0xFF000014u};
    for (const glm::uvec2 size : {glm::uvec2(5, 1), glm::uvec2(1, 5)}) {
        const Painted painted = paint(size, row, kImageLinear);
        EXPECT_EQ(painted.level(1), (std::vector{0xFF000002u, 0xFF00000Du})); // 1.6 and 12.8
        EXPECT_EQ(painted.level(2), std::vector{0xFF000008u});
    }
}

TEST(GridTextureLevels, evenColoursStayAsTheyAre) {
    for (const glm::uvec2 size : {glm::uvec2(16, 16), glm::uvec2(7, 13), glm::uvec2(1, 30)})
        for (std::uint32_t code = 0; code < 256; ++code)
            for (const std::uint32_t alpha : {255u, 100u, 1u, 0u}) {
                const std::uint32_t texel = alpha << 24 | (255u - code) << 8 | code;
                const Painted painted = paint(size, std::vector(std::size_t(size.x) * size.y, texel));
                ASSERT_EQ(painted.level(1)[0], texel);
                ASSERT_EQ(painted.level(2).back(), texel);
            }
}

} // namespace
} // namespace rt

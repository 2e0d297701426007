#include "tools/rt-grid/pack_textures.h"

#include "common/error.h"
#include "tools/rt-grid/shrink_image.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <numeric>

namespace rt {
namespace {

std::vector<std::size_t> tallestFirst(const SharedSpan<MeshImage>& images) {
    std::vector<std::size_t> order(images.size());
    std::iota(order.begin(), order.end(), std::size_t(0));
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return extentWithLevels(images[a].width, images[a].height).y >
               extentWithLevels(images[b].width, images[b].height).y;
    });
    return order;
}

// No image may be larger than `side`.
PageLayout placeOnShelves(const SharedSpan<MeshImage>& images, const std::vector<std::size_t>& order,
                          std::uint32_t side) {
    PageLayout layout;
    layout.places.resize(images.size());
    layout.width = layout.height = side;
    std::uint32_t x = 0, shelf = 0, nextShelf = 0, page = 0;
    for (const std::size_t i : order) {
        const MeshImage& image = images[i];
        const glm::uvec2 extent = extentWithLevels(image.width, image.height);
        if (x + extent.x > side) {
            x = 0;
            shelf = nextShelf;
        }
        if (shelf + extent.y > side) {
            x = shelf = 0;
            ++page;
        }
        if (x == 0) nextShelf = shelf + extent.y; // the first of a shelf is its tallest
        layout.places[i] = {glm::uvec4(x, shelf, image.width, image.height),
                            glm::uvec4(page, image.wrapU, image.wrapV, image.space)};
        x += extent.x;
    }
    layout.pageCount = page + 1;
    if (page == 0) layout.height = nextShelf;
    return layout;
}

TexelBlock levelBlock(const PageLayout& layout, const ImagePlace& place, std::uint32_t level,
                      std::vector<std::uint32_t>& texels) {
    const glm::uvec4 rect = levelRect(place.rect, level);
    const std::size_t line = std::size_t(place.page.x) * layout.height + rect.y;
    return {texels.data() + line * layout.width + rect.x, layout.width, {rect.z, rect.w}};
}

// Level 0 from `pixels`, then each from the one before.
void paintImage(const std::uint32_t* pixels, const PageLayout& layout, const ImagePlace& place,
                std::vector<std::uint32_t>& texels) {
    TexelBlock block = levelBlock(layout, place, 0, texels);
    for (std::uint32_t y = 0; y < block.size.y; ++y)
        std::copy_n(pixels + std::size_t(y) * block.size.x, block.size.x, block.first + y * block.stride);
    for (std::uint32_t level = 1; block.size != glm::uvec2(1); ++level) {
        const TexelBlock smaller = levelBlock(layout, place, level, texels);
        shrinkImage(block, smaller, place.page.w);
        block = smaller;
    }
}

} // namespace

PageLayout placeImages(const SharedSpan<MeshImage>& images, const std::string& name) {
    if (images.empty()) return {};
    std::uint32_t longest = 0;
    std::uint64_t texels = 0;
    for (const MeshImage& image : images) {
        const glm::uvec2 extent = extentWithLevels(image.width, image.height);
        longest = std::max({longest, extent.x, extent.y});
        texels += std::uint64_t(extent.x) * extent.y;
    }
    if (longest > kMaxPageSide)
        throw Error(ErrorKind::LimitExceeded,
                    fmt::format("{}: an image with its smaller levels is {} pixels wide or high; at most "
                                "{} are possible; scale it down",
                                name, longest, kMaxPageSide));
    const std::vector<std::size_t> order = tallestFirst(images);
    std::uint32_t side = std::bit_ceil(longest);
    while (side < kUsualPageSide && std::uint64_t(side) * side < texels) side *= 2;
    for (; side < kUsualPageSide; side *= 2) {
        PageLayout layout = placeOnShelves(images, order, side);
        if (layout.pageCount == 1) return layout;
    }
    return placeOnShelves(images, order, side);
}

std::vector<std::uint32_t> paintPages(const Mesh& mesh, const PageLayout& layout) {
    std::vector<std::uint32_t> texels(layout.texelCount());
    tbb::parallel_for(std::size_t(0), layout.places.size(), [&](std::size_t i) {
        paintImage(mesh.pixels.data() + mesh.images[i].firstPixel, layout, layout.places[i], texels);
    });
    return texels;
}

} // namespace rt

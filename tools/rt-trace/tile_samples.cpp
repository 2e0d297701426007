#include "tools/rt-trace/tile_samples.h"

#include <algorithm>
#include <glm/common.hpp>
#include <limits>

namespace rt {

TileSamples::TileSamples(const glm::uvec4& window, std::uint32_t goal)
    : window_(window), first_(window.x / kSide, window.y / kSide),
      count_((window.z + kSide - 1) / kSide - first_.x, (window.w + kSide - 1) / kSide - first_.y),
      tiles_(std::size_t(count_.x) * count_.y, Tile{0, goal}) {}

std::size_t TileSamples::pixelCount() const {
    return std::size_t(window_.z - window_.x) * (window_.w - window_.y);
}

// `tiles`: [xy, zw), counted from the window's first.
glm::uvec4 TileSamples::pixelsOf(const glm::uvec4& tiles) const {
    const glm::uvec4 pixels = (tiles + glm::uvec4(first_, first_)) * kSide;
    return {glm::max(glm::uvec2(pixels), glm::uvec2(window_)),
            glm::min(glm::uvec2(pixels.z, pixels.w), glm::uvec2(window_.z, window_.w))};
}

glm::uvec4 TileSamples::pixelsOf(std::size_t tile) const {
    const glm::uvec2 at(static_cast<unsigned>(tile % count_.x), static_cast<unsigned>(tile / count_.x));
    return pixelsOf(glm::uvec4(at, at + 1u));
}

std::optional<TileSamples::Round> TileSamples::nextRound() const {
    std::optional<std::uint32_t> fewest;
    for (const Tile& tile : tiles_)
        if (!tile.finished()) fewest = std::min(fewest.value_or(tile.samples), tile.samples);
    if (!fewest) return std::nullopt;
    Round round{*fewest, std::numeric_limits<std::uint32_t>::max()};
    for (const Tile& tile : tiles_)
        if (!tile.finished())
            round.most = std::min(round.most, (tile.samples == *fewest ? tile.goal : tile.samples) - *fewest);
    return round;
}

std::uint64_t TileSamples::unfinishedPixels() const {
    std::uint64_t count = 0;
    for (std::size_t i = 0; i < tiles_.size(); ++i)
        if (!tiles_[i].finished()) count += Region{pixelsOf(i), 0}.pixelCount();
    return count;
}

bool TileSamples::wanted(unsigned column, unsigned row, std::uint32_t samples) const {
    const Tile& tile = tiles_[std::size_t(row) * count_.x + column];
    return !tile.finished() && tile.samples == samples;
}

// To the right as far as it goes, then down as long as whole rows of it are wanted.
std::optional<TileSamples::Region> TileSamples::next(std::uint32_t samples, std::uint64_t mostPixels) const {
    const auto begin = std::find_if(tiles_.begin(), tiles_.end(), [=](const Tile& tile) {
        return !tile.finished() && tile.samples == samples;
    });
    if (begin == tiles_.end()) return std::nullopt;
    const auto index = static_cast<std::size_t>(begin - tiles_.begin());
    const glm::uvec2 at(static_cast<unsigned>(index % count_.x), static_cast<unsigned>(index / count_.x));
    const std::uint64_t mostTiles = std::max<std::uint64_t>(mostPixels / (kSide * kSide), 1);
    glm::uvec4 tiles(at, at + 1u);
    while (tiles.z < count_.x && tiles.z - tiles.x < mostTiles && wanted(tiles.z, at.y, samples)) ++tiles.z;
    const auto rowWanted = [&](unsigned row) {
        for (unsigned column = tiles.x; column < tiles.z; ++column)
            if (!wanted(column, row, samples)) return false;
        return true;
    };
    const std::uint64_t columns = tiles.z - tiles.x;
    while (tiles.w < count_.y && columns * (tiles.w - tiles.y + 1) <= mostTiles && rowWanted(tiles.w))
        ++tiles.w;
    return Region{pixelsOf(tiles), samples};
}

glm::uvec4 TileSamples::tileRange(const glm::uvec4& pixels) const {
    return {pixels.x / kSide - first_.x, pixels.y / kSide - first_.y,
            (pixels.z + kSide - 1) / kSide - first_.x, (pixels.w + kSide - 1) / kSide - first_.y};
}

void TileSamples::add(const Region& region, std::uint32_t count) {
    const glm::uvec4 range = tileRange(region.pixels);
    for (unsigned row = range.y; row < range.w; ++row)
        for (unsigned column = range.x; column < range.z; ++column)
            tiles_[std::size_t(row) * count_.x + column].samples += count;
}

std::uint32_t TileSamples::least() const {
    std::uint32_t least = std::numeric_limits<std::uint32_t>::max();
    for (const Tile& tile : tiles_) least = std::min(least, tile.samples);
    return least;
}

std::uint32_t TileSamples::most() const {
    std::uint32_t most = 0;
    for (const Tile& tile : tiles_) most = std::max(most, tile.samples);
    return most;
}

double TileSamples::mean() const {
    double sum = 0.0;
    for (std::size_t i = 0; i < tiles_.size(); ++i)
        sum += double(Region{pixelsOf(i), 0}.pixelCount()) * tiles_[i].samples;
    return sum / static_cast<double>(pixelCount());
}

std::vector<std::uint32_t> TileSamples::perPixel() const {
    std::vector<std::uint32_t> samples;
    samples.reserve(pixelCount());
    for (unsigned y = window_.y; y < window_.w; ++y)
        for (unsigned x = window_.x; x < window_.z; ++x)
            samples.push_back(
                tiles_[std::size_t(y / kSide - first_.y) * count_.x + (x / kSide - first_.x)].samples);
    return samples;
}

} // namespace rt

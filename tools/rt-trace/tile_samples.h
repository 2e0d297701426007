#pragma once
#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec4.hpp>
#include <optional>
#include <span>
#include <vector>

namespace rt {

/// The tiles of a picture, or of a window of it, and how many samples their pixels have and are to get. The
/// tiles' borders are those of the whole picture, whatever the window.
class TileSamples {
public:
    static constexpr unsigned kSide = 32; ///< pixels

    struct Tile {
        std::uint32_t samples = 0;
        std::uint32_t goal = 0;
        bool finished() const { return samples >= goal; }
    };
    /// Pixels of one dispatch, [xy, zw): whole tiles as far as the window has them, all with as many samples.
    struct Region {
        glm::uvec4 pixels{0};
        std::uint32_t samples = 0; ///< that they have
        std::uint64_t pixelCount() const {
            return std::uint64_t(pixels.z - pixels.x) * (pixels.w - pixels.y);
        }
    };

    TileSamples(const glm::uvec4& window, std::uint32_t goal);

    const glm::uvec4& window() const { return window_; }
    std::size_t pixelCount() const;
    std::span<const Tile> tiles() const { return tiles_; }
    std::span<Tile> tiles() { return tiles_; }
    /// Of the tile with this index.
    glm::uvec4 pixelsOf(std::size_t tile) const;

    /// What is next: tiles that are not finished and have the fewest samples, and how many more they all can
    /// have before one is finished or they are as far as others.
    struct Round {
        std::uint32_t samples = 0;
        std::uint32_t most = 0;
    };
    std::optional<Round> nextRound() const;
    /// Pixels of the tiles that are not finished.
    std::uint64_t unfinishedPixels() const;
    /// Some tiles that are not finished and have exactly `samples`: at most about `mostPixels`, one tile at
    /// least. Nothing if there are none.
    std::optional<Region> next(std::uint32_t samples, std::uint64_t mostPixels) const;
    /// The region's tiles have `count` more samples.
    void add(const Region& region, std::uint32_t count);

    /// Samples of the tile that has the fewest, or the most; of a pixel on average.
    std::uint32_t least() const;
    std::uint32_t most() const;
    double mean() const;
    /// Samples of each pixel of the window, row by row.
    std::vector<std::uint32_t> perPixel() const;

private:
    glm::uvec4 tileRange(const glm::uvec4& pixels) const;
    bool wanted(unsigned column, unsigned row, std::uint32_t samples) const;
    glm::uvec4 pixelsOf(const glm::uvec4& tiles) const;

    glm::uvec4 window_;
    glm::uvec2 first_; // tile at the window's top left, counted from the picture's
    glm::uvec2 count_;
    std::vector<Tile> tiles_; // row by row
};

} // namespace rt

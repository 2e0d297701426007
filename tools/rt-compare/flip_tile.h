#pragma once
#include "tools/rt-compare/flip.h"
#include "tools/rt-compare/flip_color.h"
#include "tools/rt-compare/flip_filters.h"

#include <optional>
#include <span>
#include <vector>

namespace rt {

/// What a FLIP of two pictures needs at every pixel.
struct FlipTask {
    const ColorPlanes* pictures[2];
    FlipFilters filters;
    FlipColors colors;
    std::optional<float> exposure; ///< factor, and tone map; absent: values from 0 to 1 as they are
    std::span<float> errors;       ///< of all pixels; each is raised to the one found
};

/// A tile's rows of filtered values, and those that are still needed unfiltered, stay in the nearer caches.
inline constexpr int kFlipTileWidth = 256, kFlipTileHeight = 256;

/// What one thread needs for a tile, kept from tile to tile.
class FlipTile {
public:
    /// Finds the errors of the pixels from (x0, y0) on: at most kFlipTileWidth x kFlipTileHeight.
    void run(const FlipTask& task, int x0, int y0);

private:
    void resize(const FlipFilters& filters);
    bool isEqual(const FlipTask& task, int x0, int y0, int endX, int endY) const;
    void loadRow(const FlipTask& task, const ColorPlanes& picture, int x0, int y, float* to) const;
    void filterAlongY(const FlipFilters& filters, int picture, int columns);
    void filterAlongX(const FlipTask& task, int columns);
    void fill(const FlipTask& task, int x0, int y0, int columns, int endY);

    int radius_ = 0;                    // of the largest filter: columns before the tile's first one
    int stride_ = 0;                    // columns of a row with its margins
    std::vector<float> rows_[2];        // of each picture: a ring of rows of Y, Cx and Cz
    std::vector<const float*> near_[2]; // of them those from radius_ above the current row to as many below
    std::vector<float> lines_[2];       // of each picture: the current row, filtered along y
    std::vector<float> errors_;         // of one row
};

} // namespace rt

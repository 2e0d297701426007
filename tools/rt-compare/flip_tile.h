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

/// A tile's columns, and of its rows the filtered ones that are still needed, stay in the nearer caches.
inline constexpr int kFlipTileWidth = 128, kFlipTileHeight = 256;

/// What one thread needs for a tile, kept from tile to tile.
class FlipTile {
public:
    /// Finds the errors of the pixels from (x0, y0) on: at most kFlipTileWidth x kFlipTileHeight.
    void run(const FlipTask& task, int x0, int y0);

private:
    void resize(const FlipFilters& filters);
    void loadRow(const FlipTask& task, const ColorPlanes& picture, int x0, int y);
    void toOpponents(const FlipTask& task, const ColorPlanes& picture);
    void filterAlongX(const FlipFilters& filters, int columns, float* lines) const;
    void filterAlongY(const FlipTask& task, int columns);
    void fill(const FlipTask& task, int x0, int y0);

    int margin_ = 0;                    // columns before the tile's first one
    int stride_ = 0;                    // columns of a row with its margins
    std::vector<float> channels_;       // 3 rows: R, G, B, then Y, Cx, Cz
    std::vector<float> lines_[2];       // of each picture: a ring of filtered rows
    std::vector<const float*> rows_[2]; // those from filters.radius above the current row to as many below
    std::vector<float> errors_;         // of one row
};

} // namespace rt

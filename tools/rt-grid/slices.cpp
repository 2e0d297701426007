#include "tools/rt-grid/slices.h"

#include "formats/heat_color.h"
#include "tools/rt-grid/atlas_cells.h"
#include "tools/rt-grid/slice_legend.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace rt {
namespace {

constexpr int kLongestSide = 960; // pixels, of a picture without its legend
constexpr int kShortestSide = 48;
constexpr double kNothing = -1.0;  // no value here
constexpr int kPlacesPerPixel = 3; // along each side, where voxels may be smaller than pixels

enum class Quantity { Occupancy, Distance, References };

const char* fileNameOf(Quantity quantity) {
    static constexpr const char* kNames[] = {"occupancy", "distance", "references"};
    return kNames[static_cast<int>(quantity)];
}

double valueAt(const Atlas& atlas, Quantity quantity, const glm::dvec3& gridPoint) {
    CellBlock block = gridBlock(atlas);
    for (;;) {
        const double scale = std::ldexp(1.0, block.level);
        const CellPlace place{
            glm::clamp(glm::ivec3(glm::floor(gridPoint * scale)), block.first, block.first + block.dims - 1),
            block.level};
        const std::uint32_t word = block.word(place.at);
        if (isBrick(word)) {
            block = brickBlock(atlas, word, place);
            continue;
        }
        if (!(word & kOccupiedBit))
            return quantity == Quantity::Distance ? leapDistance(atlas.grid.dims.w, word) / scale : kNothing;
        if (quantity == Quantity::Occupancy) return place.level;
        if (quantity == Quantity::Distance) return kNothing;
        std::size_t length = 1;
        while (!(atlas.references[leafList(word) + length] & kLastInList)) ++length;
        return static_cast<double>(length);
    }
}

// The values of a cut, row by row from the top.
struct Cut {
    int width, height;
    std::vector<double> values;
    double least = std::numeric_limits<double>::max(), most = 0.0;
};

class Cutter {
public:
    Cutter(const Atlas& atlas, int finestLevel, int axis, double at)
        : atlas_(atlas), axis_(axis), u_((axis + 1) % 3), v_((axis + 2) % 3), dims_(atlas.grid.dims) {
        if (axis_ == 1) std::swap(u_, v_); // x to the right in two of three pictures
        depth_ = std::clamp(at, 0.0, 1.0) * dims_[axis_];
        const glm::dvec3 extent = dims_ * glm::dvec3(atlas.grid.cellSize);
        const double pixel = std::max(extent[u_], extent[v_]) / kLongestSide;
        width_ = std::clamp(static_cast<int>(std::lround(extent[u_] / pixel)), kShortestSide, kLongestSide);
        height_ = std::clamp(static_cast<int>(std::lround(extent[v_] / pixel)), kShortestSide, kLongestSide);
        const double finest =
            std::ldexp(std::min(atlas.grid.cellSize[u_], atlas.grid.cellSize[v_]), -finestLevel);
        if (finest < pixel) places_ = kPlacesPerPixel;
    }
    Cut cut(Quantity quantity) const {
        Cut cut{width_, height_,
                std::vector<double>(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_))};
        tbb::parallel_for(0, height_, [&](int y) {
            for (int x = 0; x < width_; ++x)
                cut.values[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                           static_cast<std::size_t>(x)] = pixelAt(quantity, x, y);
        });
        for (const double value : cut.values) {
            if (value == kNothing) continue;
            cut.least = std::min(cut.least, value);
            cut.most = std::max(cut.most, value);
        }
        return cut;
    }
    std::string title(Quantity quantity) const {
        static constexpr const char* kMeanings[] = {"leaves, by level", "distance in grid voxels",
                                                    "triangles per leaf"};
        return fmt::format("{}, {} = {:.2f}", kMeanings[static_cast<int>(quantity)], "xyz"[axis_],
                           depth_ / dims_[axis_]);
    }
    std::string fileName(Quantity quantity) const {
        return fmt::format("{}_{}.png", fileNameOf(quantity), "xyz"[axis_]);
    }

private:
    double pixelAt(Quantity quantity, int x, int y) const {
        double value = kNothing;
        for (int j = 0; j < places_; ++j)
            for (int i = 0; i < places_; ++i) {
                glm::dvec3 point;
                point[axis_] = depth_;
                point[u_] = dims_[u_] * (x + (i + 0.5) / places_) / width_;
                point[v_] = dims_[v_] * (1.0 - (y + (j + 0.5) / places_) / height_);
                const double here = valueAt(atlas_, quantity, point);
                if (here == kNothing) continue;
                value = value == kNothing                ? here
                        : quantity == Quantity::Distance ? std::min(value, here)
                                                         : std::max(value, here);
            }
        return value;
    }

    const Atlas& atlas_;
    int axis_, u_, v_; // across the cut; to the right; up
    glm::dvec3 dims_;
    double depth_; // in voxels of the grid
    int width_, height_;
    int places_ = 1; // of a pixel, along each side
};

SlicePicture pictureOf(const Cutter& cutter, Quantity quantity) {
    const Cut cut = cutter.cut(quantity);
    const bool isLevel = quantity == Quantity::Occupancy;
    const LegendScale scale(cut.most < cut.least ? 1.0 : cut.least, cut.most < cut.least ? 1.0 : cut.most,
                            !isLevel);
    LegendCanvas canvas(cut.width, cut.height, cutter.title(quantity), scale);
    for (int y = 0; y < cut.height; ++y)
        for (int x = 0; x < cut.width; ++x) {
            const double value =
                cut.values[static_cast<std::size_t>(y) * static_cast<std::size_t>(cut.width) +
                           static_cast<std::size_t>(x)];
            if (value != kNothing) canvas.setPixel(x, y, heatColor(scale.part(value)));
        }
    return {cutter.fileName(quantity), canvas.image()};
}

} // namespace

std::vector<SlicePicture> slicesOf(const Atlas& atlas, const glm::dvec3& at) {
    std::vector<SlicePicture> pictures;
    int finestLevel = 0;
    for (const BrickPlace& brick : bricksOf(atlas, "atlas")) finestLevel = std::max(finestLevel, brick.level);
    for (int axis = 0; axis < 3; ++axis) {
        const Cutter cutter(atlas, finestLevel, axis, at[axis]);
        for (const Quantity quantity : {Quantity::Occupancy, Quantity::Distance, Quantity::References})
            if (quantity != Quantity::Distance || atlas.grid.dims.w != kStructureUniform)
                pictures.push_back(pictureOf(cutter, quantity));
    }
    return pictures;
}

} // namespace rt

#include "common/error.h"
#include "formats/atlas.h"

#include <fmt/format.h>

#include <algorithm>

namespace rt {
namespace {

class BrickWalk {
public:
    BrickWalk(const Atlas& atlas, const std::string& name)
        : atlas_(atlas), name_(name), dims_(atlas.grid.dims),
          longestSide_(std::max({dims_.x, dims_.y, dims_.z})) {}

    std::vector<BrickPlace> run() {
        for (std::size_t i = 0; i < atlas_.voxels.size(); ++i) {
            const std::uint32_t word = atlas_.voxels[i];
            if (!isBrick(word)) continue;
            const std::size_t row = i / dims_.x;
            const glm::uvec3 voxel(i % dims_.x, row % dims_.y, row / dims_.y);
            std::size_t next = places_.size();
            add(word, glm::ivec3(voxel), 0, 0);
            for (; next < places_.size(); ++next) addChildrenOf(places_[next]);
        }
        require(end_ == atlas_.bricks.size(), "its section is longer than the bricks in use");
        return std::move(places_);
    }

private:
    void require(bool holds, const char* what) const {
        if (!holds)
            throw Error(ErrorKind::InvalidContent,
                        fmt::format("{}: brick {}: {}", name_, places_.size(), what));
    }
    void addChildrenOf(const BrickPlace parent) { // a copy: places_ grows
        const std::uint32_t side = 1u << parent.shift;
        for (std::uint32_t i = 0; i < parent.words(); ++i) {
            const std::uint32_t word = atlas_.bricks[parent.offset + i];
            if (!isBrick(word)) continue;
            const glm::uvec3 voxel(i & (side - 1), (i >> parent.shift) & (side - 1), i >> (2 * parent.shift));
            add(word, parent.first + glm::ivec3(voxel), parent.level, parent.depth);
        }
    }
    void add(std::uint32_t word, const glm::ivec3& voxel, int voxelLevel, int voxelDepth) {
        const int shift = brickShift(word);
        require(shift >= 1 && shift <= int(kMaxBrickShift), "it has an impossible size");
        const BrickPlace place{brickOffset(word), shift, voxelLevel + shift, voxelDepth + 1,
                               voxel * (1 << shift)};
        require(place.level < 32 && (std::uint64_t(longestSide_) << place.level) <= kMaxFinestSide,
                "its voxels are too small");
        require(place.offset == end_, "it is not where the bricks before it end");
        require(place.words() <= atlas_.bricks.size() - end_, "it overruns its section");
        end_ += place.words();
        places_.push_back(place);
    }

    const Atlas& atlas_;
    const std::string& name_;
    glm::uvec3 dims_;
    std::uint32_t longestSide_;
    std::uint64_t end_ = 0; // of the bricks found so far
    std::vector<BrickPlace> places_;
};

} // namespace

std::vector<BrickPlace> bricksOf(const Atlas& atlas, const std::string& name) {
    return BrickWalk(atlas, name).run();
}

} // namespace rt

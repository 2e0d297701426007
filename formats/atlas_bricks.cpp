#include "common/error.h"
#include "formats/atlas.h"

#include <fmt/format.h>

#include <algorithm>

namespace rt {
namespace {

// Few are bricks: this looks at 8 words at once.
bool noneIsBrick(std::span<const std::uint32_t, 8> words) {
    std::uint32_t bothBits = 0;
    for (const std::uint32_t word : words) bothBits |= word & (word << 1);
    return (bothBits & kOccupiedBit) == 0;
}

class BrickWalk {
public:
    BrickWalk(const Atlas& atlas, const std::string& name)
        : atlas_(atlas), name_(name), dims_(atlas.grid.dims),
          longestSide_(std::max({dims_.x, dims_.y, dims_.z})) {}

    /// Calls visit(places) with the bricks of one voxel after the other.
    template <class Visit>
    void run(const Visit& visit) {
        for (std::size_t i = 0; i < atlas_.voxels.size(); ++i) {
            const std::uint32_t word = atlas_.voxels[i];
            if (!isBrick(word)) continue;
            const std::size_t row = i / dims_.x;
            const glm::uvec3 voxel(i % dims_.x, row % dims_.y, row / dims_.y);
            add(word, glm::ivec3(voxel), 0, 0);
            for (std::size_t next = 0; next < places_.size(); ++next) addChildrenOf(places_[next]);
            visit(places_);
            bricksBefore_ += places_.size();
            places_.clear();
        }
        require(end_ == atlas_.bricks.size(), "its section is longer than the bricks in use");
    }

private:
    void require(bool holds, const char* what) const {
        if (!holds)
            throw Error(ErrorKind::InvalidContent,
                        fmt::format("{}: brick {}: {}", name_, bricksBefore_ + places_.size(), what));
    }
    void addChildrenOf(const BrickPlace parent) { // a copy: places_ grows
        const std::uint32_t side = 1u << parent.shift;
        const auto words = atlas_.bricks.subspan(parent.offset, parent.words());
        for (std::uint32_t i = 0; i < words.size(); ++i) {
            if (i % 8 == 0 && noneIsBrick(words.subspan(i).first<8>())) {
                i += 7;
                continue;
            }
            const std::uint32_t word = words[i];
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
    std::size_t bricksBefore_ = 0;
    std::vector<BrickPlace> places_; // of this voxel
};

} // namespace

std::vector<BrickPlace> bricksOf(const Atlas& atlas, const std::string& name) {
    std::vector<BrickPlace> all;
    BrickWalk(atlas, name).run([&](const std::vector<BrickPlace>& places) {
        all.insert(all.end(), places.begin(), places.end());
    });
    return all;
}

void requireBricksInOrder(const Atlas& atlas, const std::string& name) {
    BrickWalk(atlas, name).run([](const std::vector<BrickPlace>&) {});
}

} // namespace rt

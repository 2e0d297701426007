#include "tools/rt-grid/vdb_export.h"

#include "common/error.h"
#include "common/log.h"
#include "tools/rt-grid/atlas_cells.h"

#include <fmt/format.h>
#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/Prune.h>
#include <xxhash.h>

#include <cmath>
#include <cstring>
#include <map>
#include <optional>
#include <sstream>
#include <vector>

namespace rt {
namespace {

// A level of the atlas: the grid, or all bricks of its voxels.
struct Level {
    int level = 0;
    std::vector<CellBlock> blocks;
};

std::vector<Level> levelsOf(const Atlas& atlas) {
    std::map<int, std::vector<CellBlock>> blocks{{0, {gridBlock(atlas)}}};
    for (const BrickPlace& brick : bricksOf(atlas, "atlas"))
        blocks[brick.level].push_back(brickBlock(atlas, brick));
    std::vector<Level> levels;
    for (auto& [level, ofLevel] : blocks) levels.push_back({level, std::move(ofLevel)});
    return levels;
}

double worldSize(const GridParams& grid, int axis) {
    return double(grid.cellSize[axis]) / double(grid.worldOffset.w);
}

// OpenVDB refuses voxels with a volume below 3e-15. By how much all grids are enlarged so that none has such:
// a power of two.
double enlargement(const GridParams& grid, int finestLevel) {
    constexpr double kLeastVolume = 0x1p-44;
    const double side = std::cbrt(worldSize(grid, 0) * worldSize(grid, 1) * worldSize(grid, 2));
    const double wanted = std::cbrt(kLeastVolume) / std::ldexp(side, -finestLevel);
    return std::exp2(std::max(0.0, std::ceil(std::log2(wanted))));
}

openvdb::math::Transform::Ptr worldFromIndex(const GridParams& grid, int level, double enlarged) {
    openvdb::Mat4d matrix = openvdb::Mat4d::identity(); // for row vectors: the last row is the translation
    for (int axis = 0; axis < 3; ++axis) {
        const double side = std::ldexp(worldSize(grid, axis), -level);
        const double lo =
            double(grid.gridLo[axis]) / double(grid.worldOffset.w) + double(grid.worldOffset[axis]);
        matrix(axis, axis) = enlarged * side;
        matrix(3, axis) = enlarged * (lo + 0.5 * side);
    }
    return openvdb::math::Transform::createLinearTransform(matrix);
}

// What the grids show of a word; nothing where a grid has no voxel.
struct Occupancy {
    using Grid = openvdb::BoolGrid;
    static constexpr const char* kName = "occupancy";
    static constexpr const char* kMeaning =
        "active and true where a voxel of this size lists triangles; those that hold smaller voxels do not";
    static std::optional<bool> of(const Atlas&, std::uint32_t word) {
        return word & kOccupiedBit && !isBrick(word) ? std::optional(true) : std::nullopt;
    }
};
struct Distance {
    using Grid = openvdb::Int32Grid;
    static constexpr const char* kName = "distance";
    static constexpr const char* kMeaning =
        "of empty voxels: how many voxels of this size rays may leap at least, whichever way they go";
    static std::optional<std::int32_t> of(const Atlas& atlas, std::uint32_t word) {
        return word & kOccupiedBit ? std::nullopt : std::optional(leapDistance(atlas.grid.dims.w, word));
    }
};
struct References {
    using Grid = openvdb::Int32Grid;
    static constexpr const char* kName = "references";
    static constexpr const char* kMeaning = "how many triangles the voxel lists";
    static std::optional<std::int32_t> of(const Atlas& atlas, std::uint32_t word) {
        if (!Occupancy::of(atlas, word)) return std::nullopt;
        std::int32_t length = 1;
        for (std::size_t i = leafList(word) + kListHeaderWords; !(atlas.references[i] & kLastInList); ++i)
            ++length;
        return length;
    }
};

template <class Shown>
openvdb::GridBase::Ptr makeGrid(const Atlas& atlas, const Level& level, double enlarged) {
    auto grid = Shown::Grid::create(0);
    auto voxels = grid->getAccessor();
    for (const CellBlock& block : level.blocks)
        for (std::size_t i = 0; i < block.words.size(); ++i)
            if (const auto value = Shown::of(atlas, block.words[i])) {
                const glm::ivec3 at = block.place(i).at;
                voxels.setValue(openvdb::Coord(at.x, at.y, at.z), *value);
            }
    openvdb::tools::pruneInactive(grid->tree());
    grid->pruneGrid();
    const bool isNested = atlas.grid.dims.w == kStructureNested;
    grid->setName(isNested ? fmt::format("{}_level{}", Shown::kName, level.level) : Shown::kName);
    grid->setGridClass(openvdb::GRID_UNKNOWN); // neither a level set nor a density
    grid->setTransform(worldFromIndex(atlas.grid, level.level, enlarged));
    grid->insertMeta("rt:meaning", openvdb::StringMetadata(Shown::kMeaning));
    grid->insertMeta("rt:structure", openvdb::StringMetadata(structureName(atlas.grid.dims.w)));
    grid->insertMeta("rt:level", openvdb::Int32Metadata(level.level));
    grid->insertMeta("rt:enlargedBy", openvdb::DoubleMetadata(enlarged));
    grid->insertMeta("rt:meshHash", openvdb::StringMetadata(fmt::format("{:016x}", atlas.info.meshHash)));
    return grid;
}

std::string streamOf(const openvdb::GridPtrVec& grids) {
    std::ostringstream stream(std::ios::binary);
    openvdb::io::Stream(stream).write(grids);
    return std::move(stream).str();
}

// A stream of several grids is what one of none begins with, but for the number of grids at its end, and then
// what follows that in the stream of each grid alone. So one grid at a time is in memory.
class GridStream {
public:
    GridStream() : bytes_(streamOf({})), headBytes_(bytes_.size()) {}
    void add(const openvdb::GridBase::Ptr& grid) {
        bytes_.append(streamOf({grid}), headBytes_);
        ++count_;
    }
    std::string finish() {
        std::memcpy(&bytes_[headBytes_ - sizeof count_], &count_, sizeof count_);
        return std::move(bytes_);
    }

private:
    std::string bytes_;
    std::size_t headBytes_;
    std::int32_t count_ = 0;
};

// All levels, coarsest first.
void addGrids(const Atlas& atlas, const Recipe& recipe, GridStream& stream) {
    const std::vector<Level> levels = levelsOf(atlas);
    const double enlarged = enlargement(atlas.grid, levels.back().level);
    if (enlarged > 1.0)
        logWarning(fmt::format(
            "the grids of the .vdb are {:g} times as large as the scene: OpenVDB has no voxels as "
            "small as {:.3g}",
            enlarged, std::ldexp(worldSize(atlas.grid, 0), -levels.back().level)));
    for (const Level& level : levels) {
        const openvdb::GridBase::Ptr occupancy = makeGrid<Occupancy>(atlas, level, enlarged);
        if (recipe.isKnown() && &level == &levels.front())
            occupancy->insertMeta(kRecipeKey, openvdb::StringMetadata(recipe.mark()));
        stream.add(occupancy);
        if (atlas.grid.dims.w != kStructureUniform) stream.add(makeGrid<Distance>(atlas, level, enlarged));
        stream.add(makeGrid<References>(atlas, level, enlarged));
    }
}

bool isHexOrDash(char c, bool dash) {
    return dash ? c == '-' : (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f');
}

bool dashAt(std::size_t i) {
    return i == 8 || i == 13 || i == 18 || i == 23;
}

// OpenVDB gives every file a random identifier. It stands as 36 characters after the magic number (8 bytes),
// the file version (4), the library version (8) and the flag for grid offsets (1). Ours comes from the
// contents instead.
void replaceIdentifier(std::string& bytes) {
    constexpr std::size_t kStart = 21;
    constexpr std::size_t kLength = 36;
    bool found = bytes.size() >= kStart + kLength;
    for (std::size_t i = 0; found && i < kLength; ++i) found = isHexOrDash(bytes[kStart + i], dashAt(i));
    if (!found)
        throw Error(ErrorKind::Internal, "OpenVDB's file header is not the one that this program knows");
    bytes.replace(kStart, kLength, kLength, '0');
    const XXH128_hash_t hash = XXH3_128bits(bytes.data(), bytes.size());
    const std::string digits = fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
    for (std::size_t i = 0, digit = 0; i < kLength; ++i)
        bytes[kStart + i] = dashAt(i) ? '-' : digits[digit++];
}

} // namespace

std::string vdbBytes(const Atlas& atlas, const Recipe& recipe) {
    openvdb::initialize();
    GridStream stream;
    addGrids(atlas, recipe, stream);
    std::string bytes = stream.finish();
    replaceIdentifier(bytes);
    return sealed(std::move(bytes), recipe);
}

} // namespace rt

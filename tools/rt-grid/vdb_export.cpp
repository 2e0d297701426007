#include "tools/rt-grid/vdb_export.h"

#include "common/error.h"

#include <fmt/format.h>
#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/Dense.h>
#include <tbb/parallel_for.h>
#include <xxhash.h>

#include <algorithm>
#include <memory>
#include <sstream>
#include <vector>

namespace rt {
namespace {

openvdb::math::Transform::Ptr worldFromIndex(const GridParams& grid) {
    openvdb::Mat4d matrix = openvdb::Mat4d::identity(); // for row vectors: the last row is the translation
    for (int axis = 0; axis < 3; ++axis) {
        const double cellSize = grid.cellSize[axis];
        const double scale = grid.worldOffset.w;
        matrix(axis, axis) = cellSize / scale;
        matrix(3, axis) = (grid.gridLo[axis] + 0.5 * cellSize) / scale + grid.worldOffset[axis];
    }
    return openvdb::math::Transform::createLinearTransform(matrix);
}

// Grid of valueOf(word) for each voxel; voxels of value 0 stay inactive.
template <class Grid, class Value, class ValueOf>
typename Grid::Ptr makeGrid(const Atlas& atlas, const char* name, const char* meaning, ValueOf&& valueOf) {
    const std::unique_ptr<Value[]> values(new Value[atlas.voxels.size()]);
    tbb::parallel_for(std::size_t(0), atlas.voxels.size(),
                      [&](std::size_t i) { values[i] = valueOf(atlas.voxels[i]); });
    const glm::ivec3 last = glm::ivec3(atlas.grid.dims) - 1;
    using Dense = openvdb::tools::Dense<Value, openvdb::tools::LayoutXYZ>;
    const Dense dense(openvdb::CoordBBox(openvdb::Coord(0), openvdb::Coord(last.x, last.y, last.z)),
                      values.get());
    auto grid = Grid::create(typename Grid::ValueType(0));
    openvdb::tools::copyFromDense(dense, *grid, typename Grid::ValueType(0));
    grid->setName(name);
    grid->setGridClass(openvdb::GRID_UNKNOWN); // neither a level set nor a density
    grid->setTransform(worldFromIndex(atlas.grid));
    grid->insertMeta("rt:meaning", openvdb::StringMetadata(meaning));
    grid->insertMeta("rt:meshHash", openvdb::StringMetadata(fmt::format("{:016x}", atlas.info.meshHash)));
    return grid;
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

std::string vdbBytes(const Atlas& atlas) {
    openvdb::initialize();
    openvdb::GridPtrVec grids;
    grids.push_back(
        makeGrid<openvdb::BoolGrid, bool>(atlas, "occupancy", "true where the voxel holds triangles",
                                          [](std::uint32_t word) { return (word & kOccupiedBit) != 0; }));
    if (atlas.grid.dims.w == kStructureCloud)
        grids.push_back(makeGrid<openvdb::Int32Grid, std::int32_t>(
            atlas, "distance", "chessboard distance to the nearest occupied voxel, in voxels",
            [](std::uint32_t word) { return word & kOccupiedBit ? 0 : static_cast<std::int32_t>(word); }));
    std::ostringstream stream(std::ios::binary);
    openvdb::io::Stream(stream).write(grids);
    std::string bytes = std::move(stream).str();
    replaceIdentifier(bytes);
    return bytes;
}

} // namespace rt

// rt-grid verify passes what the builder makes of any mesh, and sees every fault that is put into it.
#include "tests/support/make_mesh.h"
#include "tests/support/split_mix.h"
#include "tools/rt-grid/atlas_cells.h"
#include "tools/rt-grid/build_atlas.h"
#include "tools/rt-grid/verify_atlas.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

namespace rt {
namespace {

using testing::HasSubstr;

constexpr std::array kStructures{kStructureUniform, kStructureCloud, kStructureOctant, kStructureNested};

struct Case {
    std::string name;
    Mesh mesh;
};

// Triangles with corners that `cornerOf` makes of points in the unit cube.
template <class CornerOf>
Mesh scattered(int count, std::uint64_t seed, float size, const CornerOf& cornerOf) {
    test::RayNumbers numbers(seed, 0);
    std::vector<glm::vec3> corners;
    for (int i = 0; i < count; ++i) {
        const glm::vec3 centre = numbers.point();
        for (int k = 0; k < 3; ++k) corners.push_back(cornerOf(centre + size * numbers.direction()));
    }
    return test::makeTriangles(corners);
}

Mesh stackOfSheets(int count) {
    std::vector<glm::vec3> corners;
    for (int i = 0; i < count; ++i)
        for (const glm::vec2 c : {glm::vec2(0), glm::vec2(1, 0), glm::vec2(0, 1)})
            corners.emplace_back(c, i % 3 == 0 ? 0.5f : 0.25f);
    return test::makeTriangles(corners);
}

std::vector<Case> adversarialMeshes() {
    std::vector<Case> cases{
        {"slivers and giants", test::makeSliversAndGiants(200)},
        {"coplanar stack", stackOfSheets(50)},
        {"one triangle", test::makeRandomTriangles(1, 3, 0.5f)},
        {"a fan round one vertex", test::makeFan(100)},
        {"giants", scattered(20, 1, 100.0f, [](const glm::vec3& p) { return p; })},
        {"on voxel faces",
         scattered(300, 2, 0.2f, [](const glm::vec3& p) { return glm::round(p * 8.0f) / 8.0f; })},
        {"flat", scattered(200, 3, 0.1f, [](const glm::vec3& p) { return glm::vec3(p.x, p.y, 2.0f); })},
        {"on a line",
         scattered(200, 4, 0.1f, [](const glm::vec3& p) { return glm::vec3(-1.0f, p.y, 2.0f); })},
        {"copies of one point",
         test::makeTriangles(std::vector<glm::vec3>(3000, glm::vec3(1.5f, -2.0f, 7.0f)))},
        {"far sphere", test::moved(test::makeSphere(3), 1.0f, {148376, 1234, -223423})},
        {"a dense sphere in a huge square",
         test::joined(test::moved(test::makeSphere(3), 0.002f, {0.31f, 0.52f, 0.001f}),
                      test::makeTexturedSquare({}))}};
    for (const float scale : {1e-20f, 1e-7f, 1e10f, 1e20f})
        cases.push_back({fmt::format("times {}", scale),
                         test::moved(test::makeRandomTriangles(200, 5, 0.1f), scale, glm::vec3(0))});
    return cases;
}

Atlas build(const Mesh& mesh, std::uint32_t structure, const glm::uvec3& dims = glm::uvec3(0),
            double padScale = 1.0) {
    BuildOptions options;
    options.structure = structure;
    options.resolution.exact = dims;
    options.padScale = padScale;
    StageTimer timer;
    Atlas atlas = buildAtlas(MeshFile{mesh, 77}, "mesh", options, timer).atlas;
    validate(atlas, "atlas");
    return atlas;
}

std::vector<Proof> verified(const Atlas& atlas, const Mesh* mesh = nullptr) {
    StageTimer timer;
    validate(atlas, "atlas"); // what the tests change must be seen by the proof, not by the reader
    const MeshFile file{mesh ? *mesh : Mesh(), 77};
    return verifyAtlas(atlas, mesh ? &file : nullptr, timer);
}

const Faults& faultsOf(const std::vector<Proof>& proofs, const std::string& name) {
    return std::find_if(proofs.begin(), proofs.end(), [&](const Proof& p) { return p.name == name; })->faults;
}

void expectAllHold(const Atlas& atlas, const Mesh& mesh, const std::string& name) {
    for (const Proof& proof : verified(atlas, &mesh))
        EXPECT_EQ(proof.faults.count, 0u)
            << name << ": " << proof.name << ": " << testing::PrintToString(proof.faults.first);
}

TEST(GridVerify, allStructuresOfAdversarialMeshesHold) {
    for (const auto& [name, mesh] : adversarialMeshes())
        for (const std::uint32_t structure : kStructures) {
            expectAllHold(build(mesh, structure), mesh, name + ", " + structureName(structure));
            expectAllHold(build(mesh, structure, {8, 8, 8}), mesh,
                          name + " in 8^3, " + structureName(structure));
            expectAllHold(build(mesh, structure, {1, 40, 7}), mesh,
                          name + " in 1x40x7, " + structureName(structure));
        }
}

TEST(GridVerify, allStructuresOfRandomMeshesHold) {
    for (unsigned seed = 0; seed < 12; ++seed) {
        const Mesh mesh = test::makeRandomTriangles(400, seed, 0.01f * static_cast<float>(1u << (seed % 6)));
        for (const std::uint32_t structure : kStructures)
            expectAllHold(build(mesh, structure), mesh,
                          fmt::format("seed {}, {}", seed, structureName(structure)));
    }
}

TEST(GridVerify, aMillionCopiesOfOnePointHold) {
    const Mesh mesh = test::makeIndexed({glm::vec3(3.0f)}, std::vector<glm::uvec3>(1000000, glm::uvec3(0)));
    for (const std::uint32_t structure : kStructures)
        expectAllHold(build(mesh, structure, {3, 3, 3}), mesh, structureName(structure));
}

// The words of voxels that `isOne(word)` picks.
template <class IsOne>
std::vector<std::size_t> voxelsThat(const SharedSpan<std::uint32_t>& words, const IsOne& isOne) {
    std::vector<std::size_t> found;
    for (std::size_t i = 0; i < words.size(); ++i)
        if (isOne(words[i])) found.push_back(i);
    return found;
}

bool isEmpty(std::uint32_t word) {
    return !(word & kOccupiedBit);
}
bool isLeaf(std::uint32_t word) {
    return (word & kOccupiedBit) && !isBrick(word);
}

SharedSpan<std::uint32_t> changed(const SharedSpan<std::uint32_t>& words, std::size_t i, std::uint32_t word) {
    std::vector<std::uint32_t> copy(words.begin(), words.end());
    copy[i] = word;
    return copy;
}

TEST(GridVerify, aDistanceRaisedOrLoweredByOneIsSeen) {
    const Mesh mesh = test::makeRandomTriangles(30, 6, 0.1f);
    const Atlas atlas = build(mesh, kStructureCloud, {12, 11, 10});
    const std::vector<std::size_t> empty = voxelsThat(atlas.voxels, isEmpty);
    ASSERT_GT(empty.size(), 500u);
    for (std::size_t k = 0; k < empty.size(); k += 7) {
        Atlas worse = atlas;
        const std::size_t i = empty[k];
        const std::uint32_t distance = atlas.voxels[i];
        if (distance < 12) { // more is refused by the reader
            worse.voxels = changed(atlas.voxels, i, distance + 1);
            const Faults faults = faultsOf(verified(worse), "distances");
            ASSERT_GE(faults.count, 1u) << i;
            EXPECT_THAT(faults.first[0], HasSubstr(nameOf(gridBlock(atlas).place(i))));
            EXPECT_THAT(faults.first[0], HasSubstr("which lists triangle"));
        }
        if (distance == 1) continue;
        worse.voxels = changed(atlas.voxels, i, distance - 1);
        EXPECT_GE(faultsOf(verified(worse), "distances").count, 1u) << i;
    }
}

// A box of voxels in units of the finest level, upper ends excluded, and what is in it.
struct WholeBox {
    glm::i64vec3 lo, hi;
    std::uint32_t leaf = 0;
    bool meets(const WholeBox& other) const {
        for (int axis = 0; axis < 3; ++axis)
            if (lo[axis] >= other.hi[axis] || hi[axis] <= other.lo[axis]) return false;
        return true;
    }
};
WholeBox wholeBox(const CellBox& box, std::uint32_t leaf = 0) {
    const std::int64_t unit = std::int64_t(1) << (20 - box.level);
    return {glm::i64vec3(box.lo) * unit, (glm::i64vec3(box.hi) + std::int64_t(1)) * unit, leaf};
}

std::vector<std::uint32_t> listOf(const Atlas& atlas, std::uint32_t leaf) {
    std::vector<std::uint32_t> list;
    copyTriangles(atlas.references, leafList(leaf), list);
    return list;
}

// All empty voxels and leaves, found without the code under test.
struct Cell {
    CellPlace place;
    std::uint32_t word;
    std::size_t index;
    bool inBrick;
};
std::vector<Cell> cellsOf(const Atlas& atlas) {
    std::vector<Cell> cells;
    const glm::uvec3 dims(atlas.grid.dims);
    for (std::uint32_t i = 0; i < atlas.voxels.size(); ++i)
        cells.push_back({{glm::ivec3(glm::uvec3(i % dims.x, i / dims.x % dims.y, i / dims.x / dims.y)), 0},
                         atlas.voxels[i],
                         i,
                         false});
    for (const BrickPlace& brick : bricksOf(atlas, "atlas"))
        for (std::uint32_t i = 0; i < brick.words(); ++i) {
            const std::uint32_t side = 1u << brick.shift;
            const glm::ivec3 at =
                brick.first + glm::ivec3(glm::uvec3(i % side, i / side % side, i / side / side));
            cells.push_back({{at, brick.level}, atlas.bricks[brick.offset + i], brick.offset + i, true});
        }
    std::erase_if(cells, [](const Cell& cell) { return isBrick(cell.word); });
    return cells;
}

std::uint32_t grownBy(std::uint32_t box, std::uint64_t random) {
    const auto shift = static_cast<unsigned>(5 * (random % 6));
    return (box >> shift & 31u) < 31u ? box + (1u << shift) : box;
}

// Faces of boxes are moved outwards at random: the proof must complain if and only if a comparison with every
// leaf does.
TEST(GridVerify, grownBoxesAreSeenWhereTheyHoldWhatTheyMayNot) {
    for (const std::uint32_t structure : {kStructureOctant, kStructureNested}) {
        const Mesh mesh = test::makeRandomTriangles(150, 8, 0.1f);
        const Atlas atlas = build(
            mesh, structure, structure == kStructureNested ? glm::uvec3(3, 4, 3) : glm::uvec3(12, 9, 11));
        const std::vector<Cell> cells = cellsOf(atlas);
        std::vector<WholeBox> leaves;
        for (const Cell& cell : cells)
            if (isLeaf(cell.word))
                leaves.push_back(wholeBox({cell.place.at, cell.place.at, cell.place.level}, cell.word));
        int seen[2]{}, harmless = 0; // of empty voxels and of leaves
        for (std::uint64_t k = 0; k < 400; ++k) {
            const Cell& cell = cells[test::hashOf(k) % cells.size()];
            const bool leaf = isLeaf(cell.word);
            const std::uint32_t before = leaf ? atlas.references[leafList(cell.word)] : cell.word;
            const std::uint32_t after = grownBy(before, test::hashOf(k + 1000));
            Atlas worse = atlas;
            if (leaf)
                worse.references = changed(atlas.references, leafList(cell.word), after);
            else
                (cell.inBrick ? worse.bricks : worse.voxels) =
                    changed(cell.inBrick ? atlas.bricks : atlas.voxels, cell.index, after);
            const WholeBox box = wholeBox(freeBoxOf(after, cell.place));
            const std::vector<std::uint32_t> own =
                leaf ? listOf(atlas, cell.word) : std::vector<std::uint32_t>();
            const bool wrong = std::any_of(leaves.begin(), leaves.end(), [&](const WholeBox& other) {
                return box.meets(other) && !std::ranges::includes(own, listOf(atlas, other.leaf));
            });
            const Faults faults = faultsOf(verified(worse), "boxes");
            EXPECT_EQ(faults.count, wrong ? 1u : 0u) << nameOf(cell.place) << " " << before << " " << after;
            if (wrong) {
                EXPECT_THAT(faults.first, testing::Contains(HasSubstr(nameOf(cell.place))));
            }
            ++(wrong ? seen[leaf] : harmless);
        }
        EXPECT_GT(seen[0], 20);
        EXPECT_GT(seen[1], 20);
        EXPECT_GT(harmless, 20);
    }
}

// A copy of the leaf's list without the entry `left out`, behind all others; returns where.
std::uint32_t appendListWithout(std::vector<std::uint32_t>& references, std::vector<std::uint32_t> list,
                                std::size_t leftOut) {
    const auto offset = static_cast<std::uint32_t>(references.size());
    list.erase(list.begin() + static_cast<std::ptrdiff_t>(leftOut));
    references.push_back(0);
    references.insert(references.end(), list.begin(), list.end());
    references.back() |= kLastInList;
    return offset;
}

TEST(GridVerify, aDroppedReferenceIsSeen) {
    for (const std::uint32_t structure : kStructures) {
        const Mesh mesh = test::makeRandomTriangles(200, 9, 0.2f);
        const Atlas atlas = build(mesh, structure);
        const std::vector<Cell> cells = cellsOf(atlas);
        int dropped = 0;
        for (std::uint64_t k = 0; k < 60; ++k) {
            const Cell& cell = cells[test::hashOf(k) % cells.size()];
            if (!isLeaf(cell.word) || listOf(atlas, cell.word).size() < 2) continue;
            const std::vector<std::uint32_t> list = listOf(atlas, cell.word);
            const std::size_t leftOut = test::hashOf(k + 500) % list.size();
            std::vector<std::uint32_t> references(atlas.references.begin(), atlas.references.end());
            const std::uint32_t offset = appendListWithout(references, list, leftOut);
            Atlas worse = atlas;
            worse.references = std::move(references);
            (cell.inBrick ? worse.bricks : worse.voxels) =
                changed(cell.inBrick ? atlas.bricks : atlas.voxels, cell.index, leafWord(offset));
            const std::vector<Proof> proofs = verified(worse);
            EXPECT_EQ(faultsOf(proofs, "lists").count, 1u);
            EXPECT_EQ(faultsOf(proofs, "lists").first[0],
                      fmt::format("triangle {} meets {}, which does not list it", list[leftOut],
                                  nameOf(cell.place)));
            EXPECT_GE(faultsOf(proofs, "counts").count, 1u); // a list of nobody
            ++dropped;
        }
        EXPECT_GT(dropped, 10) << structureName(structure);
    }
}

TEST(GridVerify, aWrongIndexAndAnEmptiedVoxelAreSeen) {
    const Mesh mesh = test::makeSphere(3);
    for (const std::uint32_t structure : kStructures) {
        const Atlas atlas = build(mesh, structure);
        for (const Cell& cell : cellsOf(atlas)) {
            if (!isLeaf(cell.word) || test::hashOf(cell.index) % 64 != 0) continue;
            Atlas worse = atlas;
            const std::size_t entry = leafList(cell.word) + kListHeaderWords;
            const std::uint32_t word = atlas.references[entry];
            worse.references = changed(atlas.references, entry, word ^ 1u);
            EXPECT_GE(faultsOf(verified(worse), "lists").count, 1u);
            worse = atlas;
            (cell.inBrick ? worse.bricks : worse.voxels) =
                changed(cell.inBrick ? atlas.bricks : atlas.voxels, cell.index,
                        structure == kStructureCloud ? 1u : 0u);
            const Faults faults = faultsOf(verified(worse), "lists");
            EXPECT_EQ(faults.count, listOf(atlas, cell.word).size());
            EXPECT_THAT(faults.first[0], HasSubstr(nameOf(cell.place) + ", which is empty"));
        }
    }
}

TEST(GridVerify, aSmallerPadThanPromisedIsSeen) {
    const Mesh mesh = test::makeRandomTriangles(3000, 10, 0.1f);
    for (const std::uint32_t structure : kStructures) {
        Atlas atlas = build(mesh, structure, glm::uvec3(0), 0.5);
        EXPECT_GE(faultsOf(verified(atlas), "lists").count, 1u) << structureName(structure);
        EXPECT_GE(faultsOf(verified(atlas), "counts").count, 1u);
    }
}

TEST(GridVerify, wrongFiguresAndListsOutOfOrderAreSeen) {
    const Mesh mesh = test::makeSphere(2);
    const Atlas atlas = build(mesh, kStructureNested);
    const auto faultsWith = [&](const auto& change) {
        Atlas worse = atlas;
        change(worse);
        return faultsOf(verified(worse), "counts").count;
    };
    EXPECT_EQ(faultsWith([](Atlas&) {}), 0u);
    EXPECT_EQ(faultsWith([](Atlas& a) { ++a.info.occupiedVoxels; }), 1u);
    EXPECT_EQ(faultsWith([](Atlas& a) { --a.info.references; }), 1u);
    EXPECT_EQ(faultsWith([](Atlas& a) { a.info.worldHi[1] += 1e-7; }), 1u);
    EXPECT_EQ(faultsWith([](Atlas& a) { a.info.padCells *= 0.99; }), 1u);
    EXPECT_GE(faultsWith([&](Atlas& a) { // two entries change places
                  std::vector<std::uint32_t> references(a.references.begin(), a.references.end());
                  for (const Cell& cell : cellsOf(a)) {
                      if (!isLeaf(cell.word) || listOf(a, cell.word).size() < 3) continue;
                      std::swap(references[leafList(cell.word) + 1], references[leafList(cell.word) + 2]);
                      break;
                  }
                  a.references = std::move(references);
              }),
              1u);
    Atlas cloud = build(mesh, kStructureCloud);
    ++cloud.info.maxDistance;
    EXPECT_EQ(faultsOf(verified(cloud), "distances").count, 1u);
    for (const std::uint32_t structure :
         {kStructureUniform, kStructureCloud}) { // shaders would take it for a distance
        Atlas flat = build(mesh, structure);
        flat.references = changed(flat.references, 0, 33);
        EXPECT_EQ(faultsOf(verified(flat), "distances").count, 1u);
    }
}

TEST(GridVerify, anotherMeshThanTheSourceIsSeen) {
    const Mesh mesh = test::makeTexturedSquare({{5, 9}, {3, 2}});
    const Atlas atlas = build(mesh, kStructureNested);
    EXPECT_EQ(faultsOf(verified(atlas, &mesh), "source").count, 0u);
    const auto faultsWith = [&](const auto& change) {
        Mesh other = mesh;
        change(other);
        return faultsOf(verified(atlas, &other), "source").count;
    };
    const auto altered = [](const auto& values, const auto& change) {
        std::vector copy(values.begin(), values.end());
        change(copy);
        return copy;
    };
    EXPECT_GE(faultsWith([&](Mesh& m) {
                  m.positions = altered(m.positions, [](auto& v) { v[1].x = std::nextafter(v[1].x, 2.0f); });
              }),
              1u);
    EXPECT_EQ(faultsWith([&](Mesh& m) { m.normals = altered(m.normals, [](auto& v) {
                                            v[1] = {0, 1, 0};
                                        }); }),
              1u);
    EXPECT_EQ(
        faultsWith([&](Mesh& m) { m.texcoords = altered(m.texcoords, [](auto& v) { v[2].y += 0.5f; }); }),
        1u);
    EXPECT_EQ(faultsWith([&](Mesh& m) { m.pixels = altered(m.pixels, [](auto& v) { v[44] ^= 1; }); }), 1u);
    EXPECT_EQ(faultsWith([&](Mesh& m) {
                  m.materials = altered(m.materials, [](auto& v) { v[0].reflection.y = 0.123f; });
              }),
              1u);
    EXPECT_EQ(faultsWith([&](Mesh& m) { m.triangles = altered(m.triangles, [](auto& v) { v.pop_back(); }); }),
              2u);
    EXPECT_EQ(faultsWith([&](Mesh& m) { m.lights = altered(m.lights, [](auto& v) { v.resize(1); }); }), 1u);
    StageTimer timer;
    const MeshFile otherHash{mesh, 78};
    EXPECT_EQ(faultsOf(verifyAtlas(atlas, &otherHash, timer), "source").count, 1u);
}

} // namespace
} // namespace rt

// Damaged and invalid atlases: they are uploaded while they are still being checked, and refused all the
// same.
#include "formats/atlas_file.h"
#include "formats/mesh_file.h"
#include "formats/section_file.h"
#include "tests/support/make_mesh.h"
#include "tests/support/read_text.h"
#include "tests/support/run_command.h"
#include "tests/support/temporary_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <functional>
#include <set>

namespace rt {
namespace {

using test::CommandResult;
using testing::HasSubstr;
using Words = std::vector<std::uint32_t>;

void spit(const std::string& path, const std::string& bytes) {
    std::ofstream(path, std::ios::binary) << bytes;
}

class DamagedAtlas : public testing::Test {
protected:
    void makeAtlas(const Mesh& mesh, const char* structure) {
        writeMesh(folder_.file("s.rtmesh"), mesh);
        const CommandResult grid = test::runCommand({RT_BIN_DIR "/rt-grid", folder_.file("s.rtmesh"), "-o",
                                                     path_, "--structure", structure, "--quality", "best"});
        ASSERT_EQ(grid.exitCode, 0) << grid.err;
        const float ray[8] = {0, 0, 5, 0, 0, 0, -1, 1e30f};
        spit(rays_, std::string(reinterpret_cast<const char*>(ray), sizeof(ray)));
    }

    // Pictures and ray queries both end with this code and one line that ends so, and write nothing.
    void expectRefused(const std::string& message, int exitCode = 4,
                       const std::vector<std::string>& more = {}) {
        const test::TemporaryFolder out;
        std::vector<std::string> picture = {RT_BIN_DIR "/rt-trace", path_, "-o", out.file("out.exr"), "-q"};
        std::vector<std::string> query = picture;
        query.insert(query.end(), {"--rays", rays_});
        picture.insert(picture.end(), {"--size", "8"});
        for (std::vector<std::string> command : {picture, query}) {
            command.insert(command.end(), more.begin(), more.end());
            const CommandResult result = test::runCommand(command);
            EXPECT_EQ(result.exitCode, exitCode) << result.err;
            EXPECT_THAT(result.err, HasSubstr("rt-trace: error: " + path_ + ": " + message));
            EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
            EXPECT_EQ(out.entryCount(), 0u) << "something was left behind";
        }
    }

    // As expectRefused(), of the atlas with this change and right checksums.
    void expectRefusedWith(const std::function<void(Atlas&)>& spoil, const std::string& message,
                           int exitCode = 4) {
        const std::string good = test::readText(path_);
        {
            Atlas atlas = readAtlas(path_).atlas;
            spoil(atlas);
            writeAtlas(path_, atlas);
        }
        expectRefused(message, exitCode);
        spit(path_, good);
    }

    test::TemporaryFolder folder_;
    const std::string path_ = folder_.file("s.rtatlas");
    const std::string rays_ = folder_.file("rays");
};

template <class T>
void change(SharedSpan<T>& values, std::size_t index, const std::function<void(T&)>& doing) {
    std::vector<T> changed(values.begin(), values.end());
    doing(changed.at(index));
    values = std::move(changed);
}

TEST_F(DamagedAtlas, AWrongByteInAnySectionIsReportedAsDamage) {
    std::set<std::string> names;
    for (const Mesh& mesh : {test::makeTexturedSquare({{16, 16}}), test::makeSliversAndGiants(3000)}) {
        makeAtlas(mesh, "nested");
        const std::string good = test::readText(path_);
        FileHeader header;
        std::memcpy(&header, good.data(), sizeof(header));
        for (std::uint32_t i = 0; i < header.sectionCount; ++i) {
            SectionEntry entry;
            std::memcpy(&entry, good.data() + sizeof(header) + i * sizeof(entry), sizeof(entry));
            std::string bad = good;
            char& byte = bad[entry.offset + entry.bytes * 2 / 3];
            byte = static_cast<char>(byte ^ 0xC0);
            spit(path_, bad);
            const std::string name(reinterpret_cast<const char*>(&entry.id), 4);
            expectRefused("section " + name + " is damaged (wrong checksum)");
            names.insert(name);
        }
    }
    EXPECT_THAT(names, testing::UnorderedElementsAre("INFO", "GRID", "VOXL", "BRIK", "REFS", "TRIS", "TVTX",
                                                     "NORM", "TEXC", "MATL", "IMGS", "TEXP", "RECP"));
}

TEST_F(DamagedAtlas, AWrongWordDeepInASectionIsReported) {
    makeAtlas(test::makeSphere(4), "cloud");
    const std::size_t triangles = readAtlas(path_).atlas.triangles.size();
    const std::string last = std::to_string(triangles - 1);
    expectRefusedWith(
        [&](Atlas& a) { change<std::uint32_t>(a.voxels, 12345, [](auto& v) { v = 1u << 30; }); },
        "voxel 12345 is invalid");
    expectRefusedWith(
        [&](Atlas& a) { change<std::uint32_t>(a.references, 0, [](auto& v) { v = 0xFFFFFFFFu; }); },
        "list word 0 is invalid");
    expectRefusedWith(
        [&](Atlas& a) { change<TriangleRecord>(a.triangles, triangles - 1, [](auto& t) { t.v1.x = NAN; }); },
        "triangle " + last + " is invalid");
    for (const int component : {0, 3}) // a vertex, the material
        expectRefusedWith(
            [&](Atlas& a) {
                change<glm::uvec4>(a.triangleVertices, triangles - 1, [&](auto& t) { t[component] = ~0u; });
            },
            "triangle " + last + " is invalid");
}

// What is asked of the device follows from the file: it must not be believed before it has been checked.
TEST_F(DamagedAtlas, ImpossibleSizesAreReported) {
    makeAtlas(test::makeSphere(3), "cloud");
    const char* const wrongProduct = "number of voxels is not the product of the dimensions";
    expectRefusedWith([](Atlas& a) { a.grid.dims.z += 1; }, wrongProduct);
    expectRefusedWith([](Atlas& a) { a.grid.dims = {65536, 65536, 65536, kStructureCloud}; }, wrongProduct);
    expectRefusedWith([](Atlas& a) { a.grid.dims.x = 0; }, "grid dimensions out of range");
    expectRefusedWith([](Atlas& a) { a.grid.counts.w = ~0u; }, "counts in GRID differ");
    expectRefusedWith([](Atlas& a) { a.grid.cellSize.x = NAN; }, "voxel size out of range");
    expectRefusedWith([](Atlas& a) { a.info.worldHi[1] = INFINITY; }, "scene bounds are not finite");
    const auto withImage = [](Atlas& a) {
        change<Material>(a.materials, 0, [](Material& m) { m.images.x = 0; });
    };
    expectRefusedWith(withImage, "material 0 is invalid");
    const auto withPages = [&](Atlas& a) {
        withImage(a);
        a.info.pageCount = 5;
    };
    expectRefusedWith(withPages, "number of texels is not that of the texture pages");
}

// The device refuses it in both cases.
TEST_F(DamagedAtlas, TheFilesErrorComesBeforeTheDevices) {
    makeAtlas(test::makeSphere(3), "uniform");
    const auto withLongGrid = [](Atlas& a) {
        a.grid.dims = {65536, 1, 1, kStructureUniform};
        a.voxels = Words(65536, 0u);
    };
    expectRefusedWith(withLongGrid, "a grid of 65536x1x1 voxels", 5);
    const auto withWrongVoxel = [&](Atlas& a) {
        withLongGrid(a);
        change<std::uint32_t>(a.voxels, 50000, [](auto& v) { v = 77; });
    };
    expectRefusedWith(withWrongVoxel, "voxel 50000 is invalid");
    std::string bytes = test::readText(path_);
    bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
    spit(path_, bytes);
    expectRefused("section ", 4, {"--device", "999"});
}

} // namespace
} // namespace rt

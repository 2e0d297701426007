// Models that others made: counts as their makers state them.
#include "common/stage_timer.h"
#include "tests/support/scenes.h"
#include "tools/rt-import/files_asked.h"
#include "tools/rt-import/import_model.h"

#include <gmock/gmock.h>

#include <filesystem>

namespace rt {
namespace {

ImportedModel import(const std::string& path) {
    StageTimer timer;
    return importModel(path, {}, timer);
}

TEST(ImportScenes, PoolTableIsWhole) {
    const ImportedModel model = import(test::poolTablePath());
    EXPECT_EQ(model.mesh.triangles.size(), 56576u); // 57,184, less 608 without area
    EXPECT_EQ(model.mesh.images.size(), 17u);
    EXPECT_EQ(FilesAsked({test::poolTablePath()}, {}).found(model.filesAsked).size(), 18u); // with the .mtl
    EXPECT_THAT(model.report.warnings, testing::IsEmpty());
}

struct SceneCase {
    const char* path;
    std::size_t triangles; // of the file, all of them kept or entered as dropped
    std::size_t images;
};

void PrintTo(const SceneCase& c, std::ostream* os) {
    *os << c.path;
}

class ImportScene : public testing::TestWithParam<SceneCase> {};

TEST_P(ImportScene, HasItsTrianglesAndImages) {
    const std::string path = test::scenePath(GetParam().path);
    if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is absent";
    const ImportedModel model = import(path);
    const Ledger& ledger = model.report.ledger;
    EXPECT_EQ(model.mesh.triangles.size() + ledger[Defect::NoArea].count + ledger[Defect::Duplicates].count,
              GetParam().triangles);
    EXPECT_EQ(model.mesh.images.size(), GetParam().images);
}

INSTANTIATE_TEST_SUITE_P(
    Files, ImportScene,
    testing::Values(SceneCase{"models/3ds/test1.3ds", 108, 3}, // names in another letter case
                    SceneCase{"models/3ds/horse.3ds", 7172, 0},
                    SceneCase{"models/statues/bun_zipper.ply", 69451, 0},
                    SceneCase{"models/formats/Spider_ascii.stl", 1368, 0},
                    SceneCase{"models/formats/Spider_binary.stl", 1368, 0},
                    SceneCase{"models/formats/spider_obj/spider.obj", 1368, 4},
                    SceneCase{"models/interior/vr-gallery.glb", 1930, 1}, // embedded image
                    SceneCase{"models/formats/spider.fbx", 1368, 0},
                    SceneCase{"models/formats/duck.dae", 4212, 1},
                    SceneCase{"models/formats/Wuson.off", 3732, 0},
                    SceneCase{"models/gltf/2CylinderEngine.glb", 121496, 0}, // with instances
                    SceneCase{"models/gltf/TextureSettingsTest/TextureSettingsTest.gltf", 72, 8}));

// Seen from -z, where the model faces, its four quads carry the quarters of the picture that name their
// places.
TEST(ImportScenes, TextureCoordinateTestIsUpright) {
    const std::string path = test::scenePath("models/gltf/TextureCoordinateTest/TextureCoordinateTest.gltf");
    if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is absent";
    const Mesh mesh = import(path).mesh;
    std::size_t quadVertices = 0;
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
        if (mesh.positions[v].z > 0.01f) continue; // the plate behind them
        ++quadVertices;
        EXPECT_EQ(mesh.texcoords[v].y > 0.5f, mesh.positions[v].y > 0.0f) << "vertex " << v;
        EXPECT_EQ(mesh.texcoords[v].x<0.5f, mesh.positions[v].x> 0.0f) << "vertex " << v;
    }
    EXPECT_EQ(quadVertices, 16u);
}

} // namespace
} // namespace rt

// Scene files: what they place and merge, and what is wrong with them.
#include "tests/unit/scene_files.h"

#include <gmock/gmock.h>

namespace rt {
namespace {

using test::expectNear;
using test::fourColourImage;
using test::gltfTriangle;
using test::SceneFiles;
using test::vectorOf;
using testing::ElementsAre;
using testing::HasSubstr;

TEST_F(SceneFiles, AModelIsScaledThenTurnedThenMoved) {
    const auto p = positions(R"({"models": [{"file": "t.obj", "transform":
        {"translate": [10, 0, 0], "rotate": [0, 0, 90], "scale": [2, 1, 1]}}]})");
    ASSERT_EQ(p.size(), 3u);
    expectNear(p[0], {10, 2, 0});
    expectNear(p[1], {10, 4, 0});
    expectNear(p[2], {7, 2, 0});
}

TEST_F(SceneFiles, AnglesTurnAboutXThenYThenZ) {
    const auto p = positions(R"({"models": [{"file": "t.obj", "transform": {"rotate": [90, 90, 0]}}]})");
    expectNear(p[2], {3, 0, -1}); // (1,3,0) -> (1,0,3) -> (3,0,-1)
    const auto q = positions(R"({"models": [{"file": "t.obj", "transform":
        {"rotate": {"axis": [0, 0, -5], "degrees": 90}}}]})");
    expectNear(q[2], {3, -1, 0});
}

TEST_F(SceneFiles, AMatrixStandsColumnByColumn) {
    const auto p = positions(R"({"models": [{"file": "t.obj", "transform":
        {"matrix": [0,1,0,0, -1,0,0,0, 0,0,1,0, 5,6,7,1]}}]})");
    expectNear(p[1], {5, 8, 7});
    expectNear(p[2], {2, 7, 7});
}

TEST_F(SceneFiles, InstancesMoveWhatTheTransformMade) {
    const ImportedModel model = importText(R"({"models": [{"file": "t.obj", "transform": {"scale": 2},
        "instances": [{"translate": [0, 0, 1]}, {"scale": [-1, 1, 1]}]}]})");
    ASSERT_EQ(model.mesh.triangles.size(), 2u);
    EXPECT_EQ(model.mesh.materials.size(), 1u);
    const auto corner = [&](int triangle, int k) {
        return model.mesh.positions[model.mesh.triangles[std::size_t(triangle)][k]];
    };
    expectNear(corner(0, 0), {2, 0, 1});
    expectNear(corner(1, 0), {-2, 0, 0});
    expectNear(corner(1, 1), {-2, 6, 0}); // a mirror turns the corners round
}

TEST_F(SceneFiles, UnitsAndAxesOfAModelBecomeTheScenes) {
    expectNear(positions(R"({"models": [{"file": "t.obj", "units": "cm", "upAxis": "z"}]})")[2],
               {0.01, 0, -0.03});
    expectNear(positions(R"({"units": "cm", "models": [{"file": "t.obj", "units": "in"}]})")[1],
               {5.08, 0, 0});
    expectNear(positions(R"({"units": "mm", "models": [{"file": "t.obj"}]})")[1], {2, 0, 0});
    // The transform counts in the scene's axes, of which z is up; the result has +y up.
    expectNear(
        positions(
            R"({"upAxis": "z", "models": [{"file": "t.obj", "transform": {"translate": [0, 0, 9]}}]})")[0],
        {1, 9, 0});
    expectNear(positions(R"({"upAxis": "x", "models": [{"file": "t.obj"}]})")[1], {0, 2, 0});
}

TEST_F(SceneFiles, GltfIsInMetresAndYIsUp) {
    write("t.gltf", gltfTriangle(*this, {0, 0, 1}, R"({"mesh":0})"));
    expectNear(positions(R"({"units": "cm", "models": [{"file": "t.gltf"}]})")[1], {100, 0, 0});
    const auto p = positions(
        R"({"upAxis": "z", "models": [{"file": "t.gltf", "transform": {"translate": [0, 0, 1]}}]})");
    expectNear(p[2], {0, 2, 0});
}

TEST_F(SceneFiles, SceneFilesMayNameSceneFiles) {
    write("sub/inner.scene.json", R"({"units": "cm", "upAxis": "z",
        "models": [{"file": "t.obj", "materials": [{"match": "*", "metallic": 0.5}]}],
        "lights": [{"kind": "point", "position": [0, 0, 100], "intensity": 1}],
        "cameras": [{"name": "c", "eye": [0, 0, 100], "lookAt": [100, 0, 100]}]})");
    write("sub/t.obj", "v 0 0 0\nv 100 0 0\nv 0 0 100\nf 1 2 3\n");
    const ImportedModel model = importText(R"({"models": [{"file": "sub/inner.scene.json",
        "materials": [{"match": "*", "roughness": 0.25}],
        "instances": [{}, {"translate": [0, 5, 0]}]}]})");
    ASSERT_EQ(model.mesh.triangles.size(), 2u);
    expectNear(model.mesh.positions[2], {0, 1, 0});
    EXPECT_EQ(model.mesh.materials[0].reflection.x, 0.5f);
    EXPECT_EQ(model.mesh.materials[0].reflection.y, 0.25f)
        << "what stands outside counts after what is inside";
    ASSERT_EQ(model.mesh.lights.size(), 2u);
    expectNear(glm::vec3(model.mesh.lights[1].position), {0, 6, 0});
    EXPECT_NEAR(model.mesh.lights[0].intensity.x, 1e-4f, 1e-9f) << "a light of a smaller scene is dimmer";
    ASSERT_EQ(model.mesh.cameras.size(), 2u);
    EXPECT_STREQ(model.mesh.cameras[1].name, "c.1");
    expectNear(vectorOf(model.mesh.cameras[1].eye), {0, 6, 0});
    expectNear(vectorOf(model.mesh.cameras[0].up), {0, 0.01, 0});
    EXPECT_THAT(model.filesAsked, HasSubstr("0/sub/inner.scene.json"));
}

TEST_F(SceneFiles, SceneFilesThatNameEachOtherEnd) {
    EXPECT_THAT(refusal(R"({"models": [{"file": "s.scene.json"}]})"), HasSubstr("is named by 8 scene files"));
    const std::string twice = R"({"models": [{"file": "t.obj", "instances": [)" + [] {
        std::string many = "{}";
        for (int i = 1; i < 2000; ++i) many += ",{}";
        return many;
    }() + "]}]}";
    write("many.scene.json", twice);
    std::string more = twice;
    more.replace(more.find("t.obj"), 5, "many.scene.json");
    EXPECT_THAT(refusal(more, ErrorKind::LimitExceeded), HasSubstr("more than 1048576"));
}

TEST_F(SceneFiles, SeveralInputsAreMergedInOrder) {
    write("four.ppm", fourColourImage());
    write("a.obj", "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nvn 0 0 -1\nusemtl a\n"
                   "f 1/1/1 2/2/1 3/3/1\n");
    write("a.mtl", "newmtl a\nmap_Kd four.ppm\n");
    write("b.obj", "mtllib b.mtl\nv 5 0 0\nv 6 0 0\nv 5 1 0\nvt 1 1\nusemtl b\nf 1/1 2/1 3/1\n");
    write("copy.ppm", fourColourImage());
    write("b.mtl", "newmtl b\nmap_Kd copy.ppm\n");
    write("c.stl", "solid c\nfacet normal 0 0 0\nouter loop\nvertex 8 0 0\nvertex 9 0 0\nvertex 8 1 "
                   "0\nendloop\nendfacet\n"
                   "endsolid c\n");
    write("s.scene.json", R"({"units": "mm", "models": [{"file": "t.obj"}],
        "cameras": [{"name": "c", "eye": [0, 0, 1], "lookAt": [0, 0, 0]}, {"name": "c", "eye": [0, 0, 2], "lookAt": [0, 0, 0]}]})");
    const Mesh mesh = importInputs({"c.stl", "a.obj", "s.scene.json", "b.obj"}).mesh;
    ASSERT_EQ(mesh.triangles.size(), 4u);
    EXPECT_THAT(std::vector(mesh.triangleMaterial.begin(), mesh.triangleMaterial.end()),
                ElementsAre(0, 1, 2, 3));
    const auto first = [&](std::size_t t) { return mesh.triangles[t].x; };
    EXPECT_EQ(mesh.positions[first(0)], glm::vec3(8, 0, 0));
    EXPECT_EQ(mesh.positions[first(2)], glm::vec3(1, 0, 0))
        << "other inputs count in the unit of the scene file";
    EXPECT_EQ(mesh.normals[first(0)], glm::vec3(0, 0, 1)) << "generated";
    EXPECT_EQ(mesh.normals[first(1)], glm::vec3(0, 0, -1)) << "the file's own";
    EXPECT_EQ(mesh.texcoords[first(0)], glm::vec2(0, 0));
    EXPECT_EQ(mesh.texcoords[mesh.triangles[1].y], glm::vec2(1, 0));
    EXPECT_EQ(mesh.texcoords[first(3)], glm::vec2(1, 1));
    EXPECT_EQ(mesh.materials[0].images.x, kNoImage);
    EXPECT_EQ(mesh.materials[1].images.x, mesh.materials[3].images.x) << "two files with the same picture";
    EXPECT_EQ(mesh.images.size(), 1u);
    EXPECT_EQ(mesh.pixels.size(), 4u);
    EXPECT_STREQ(mesh.cameras[1].name, "c.1");
}

TEST_F(SceneFiles, WarningsNameTheModelWhereThereAreSeveral) {
    write("t.mtl", "newmtl stone\nmap_Kd gone.ppm\n");
    EXPECT_THAT(importInputs({"t.obj"}).report.warnings,
                ElementsAre(testing::StartsWith("material 'stone'")));
    write("u.obj", "mtllib t.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl stone\nf 1 2 3\n");
    EXPECT_THAT(importInputs({"t.obj", "u.obj"}).report.warnings,
                ElementsAre(testing::StartsWith(path("t.obj") + ": material 'stone'"),
                            testing::StartsWith(path("u.obj") + ": material 'stone'")));
}

TEST_F(SceneFiles, AModelWithoutTrianglesIsNoErrorBesideOthers) {
    write("p.obj", "v 0 0 0\nv 1 0 0\np 1 2\n");
    EXPECT_EQ(importInputs({"p.obj", "t.obj", "p.obj"}).mesh.triangles.size(), 1u);
    EXPECT_THAT(refusal(R"({"models": [{"file": "p.obj"}]})"), HasSubstr("has no triangles"));
    EXPECT_THAT(refusal(R"({"models": []})"), HasSubstr("has no triangles"));
}

TEST_F(SceneFiles, TogetherTheyHaveToFitIntoFloats) {
    write("far.obj", "v 3e38 0 0\nv 3.1e38 0 0\nv 3e38 1e37 0\nf 1 2 3\n");
    EXPECT_THAT(
        refusal(R"({"models": [{"file": "far.obj"}, {"file": "far.obj", "transform": {"scale": -1}}]})"),
        HasSubstr("overflows 32 bits"));
}

TEST_F(SceneFiles, ErrorsNameTheirPlace) {
    const auto model = [&](const std::string& more) {
        return refusal(R"({"models": [{"file": "t.obj", )" + more + "}]}");
    };
    EXPECT_THAT(refusal("{"), HasSubstr("is no JSON"));
    EXPECT_EQ(refusal("[]"),
              "/: is no object {$schema, units, upAxis, models, materials, lights, cameras, environment, "
              "background}");
    EXPECT_THAT(refusal(R"({"model": []})"), HasSubstr("/: 'model' is none of "));
    EXPECT_EQ(refusal(R"({"models": {}})"), "/models: is no array");
    EXPECT_EQ(refusal(R"({"models": [{}]})"), "/models/0: file is missing");
    EXPECT_EQ(refusal(R"({"models": [{"file": 3}]})"), "/models/0/file: is no text");
    EXPECT_THAT(refusal(R"({"models": [{"file": "u.obj"}]})", ErrorKind::FileAccess),
                HasSubstr("/models/0/file: 'u.obj' was not found"));
    EXPECT_EQ(model(R"("transform": {"translat": [0, 0, 0]})"),
              "/models/0/transform: 'translat' is none of matrix, translate, rotate, scale");
    EXPECT_EQ(model(R"("transform": {"scale": 0})"),
              "/models/0/transform: flattens or overflows what it moves");
    EXPECT_EQ(model(R"("transform": {"matrix": [1]})"), "/models/0/transform/matrix: is no array of 16");
    EXPECT_THAT(model(R"("transform": {"matrix": [1,0,0,0,0,1,0,0,0,0,1,5,0,0,0,1]})"),
                HasSubstr("last row"));
    EXPECT_THAT(model(R"("transform": {"matrix": [1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1], "scale": 2})"),
                HasSubstr("/transform: has a matrix and translate, rotate or scale"));
    EXPECT_THAT(model(R"("transform": {"materials": []})"), HasSubstr("'materials' is none of matrix"));
    EXPECT_THAT(model(R"("instances": [{}, {"materials": [{"ior": 2}]}])"),
                HasSubstr("/models/0/instances/1/materials/0: "));
    EXPECT_EQ(model(R"("instances": [{}, {"rotate": 90}])"),
              "/models/0/instances/1/rotate: is no object {axis, degrees}");
    EXPECT_THAT(model(R"("instances": [])"), HasSubstr("/models/0/instances: is empty"));
    EXPECT_THAT(model(R"("units": "yard")"), HasSubstr("/models/0/units: is none of m, cm"));
    EXPECT_THAT(model(R"("units": -1)"), HasSubstr("/models/0/units: -1 is not above 0"));
    EXPECT_THAT(model(R"("upAxis": "w")"), HasSubstr("/models/0/upAxis: is none of x, y, z"));
    EXPECT_THAT(model(R"("materials": [{"roughness": 1}])"),
                HasSubstr("/models/0/materials/0: match is missing"));
    EXPECT_THAT(model(R"("materials": [{"match": "*", "ior": 0.5}])"),
                HasSubstr("/models/0/materials/0/ior: 0.5 is not between 1 and 100"));
    EXPECT_THAT(model(R"("materials": [{"match": "*", "baseColor": [0, 2, 0]}])"),
                HasSubstr("/baseColor/1: 2 is not"));
    EXPECT_THAT(model(R"("materials": [{"match": "*", "rough": 1}])"),
                HasSubstr("'rough' is none of match, "));
    EXPECT_THAT(refusalWith(R"("lights": [{"kind": "lamp", "intensity": 1}])"),
                HasSubstr("/lights/0/kind: is none of"));
    EXPECT_THAT(
        refusalWith(R"("lights": [{"kind": "point", "intensity": 1, "position": [0, 0, 0], "radius": 1}])"),
        HasSubstr("/lights/0: 'radius' is none of"));
    EXPECT_THAT(refusalWith(R"("lights": [{"kind": "point", "position": [0, 0, 0]}])"),
                HasSubstr("/lights/0: intensity is missing"));
    EXPECT_THAT(refusalWith(R"("lights": [{"kind": "spot", "intensity": 1, "position": [0, 0, 0]}])"),
                HasSubstr("/lights/0: needs either direction or lookAt"));
    EXPECT_THAT(
        refusalWith(
            R"("lights": [{"kind": "spot", "intensity": 1, "position": [0, 0, 0], "lookAt": [0, 0, 0]}])"),
        HasSubstr("is where the light stands"));
    EXPECT_THAT(
        refusalWith(
            R"("lights": [{"kind": "spot", "intensity": 1, "position": [0, 0, 0], "direction": [0, 0, 1],
                                 "outerAngle": 20, "innerAngle": 30}])"),
        HasSubstr("/innerAngle: 30 is not between 0 and 20"));
    EXPECT_THAT(
        refusalWith(R"("lights": [{"kind": "sphere", "intensity": 1, "position": [0, 0, 0], "radius": 0}])"),
        HasSubstr("/radius: 0 is not above 0"));
    EXPECT_THAT(refusalWith(R"("lights": [{"kind": "point", "intensity": 1, "position": [1e300, 0, 0]}])"),
                HasSubstr("too large or too small"));
    EXPECT_THAT(refusalWith(R"("cameras": [{"name": "c", "eye": [0, 0, 0], "lookAt": [0, 0, 0]}])"),
                HasSubstr("/cameras/0: eye and lookAt are the same"));
    EXPECT_THAT(refusalWith(R"("cameras": [{"name": "c", "eye": [0, 1, 0], "lookAt": [0, 0, 0]}])"),
                HasSubstr("/cameras/0: up is 0 or parallel"));
    EXPECT_THAT(refusalWith(R"("cameras": [{"name": ")" + std::string(64, 'x') +
                            R"(", "eye": [0, 0, 1], "lookAt": [0, 0, 0]}])"),
                HasSubstr("/cameras/0/name: has 64 bytes"));
    EXPECT_THAT(
        refusalWith(R"("cameras": [{"name": "c", "eye": [0, 0, 1], "lookAt": [0, 0, 0], "fov": 180}])"),
        HasSubstr("/fov: 180 is not between 0 and 180 degrees"));
    EXPECT_THAT(
        refusalWith(
            R"("cameras": [{"name": "c", "kind": "panorama", "eye": [0, 0, 1], "lookAt": [0, 0, 0], "fov": 9}])"),
        HasSubstr("/cameras/0: 'fov' is none of"));
    EXPECT_THAT(refusalWith(R"("cameras": [{"name": "c", "path": []}])"),
                HasSubstr("/cameras/0/path: is no JSON array"));
    const auto frames = [&](const std::string& first, const std::string& second) {
        return refusalWith(
            R"("cameras": [{"name": "c", "path": [{"eye": [0,0,1], "lookAt": [0,0,0], "frame": )" + first +
            R"(}, {"eye": [0,0,2], "lookAt": [0,0,0], "frame": )" + second + "}]}]");
    };
    EXPECT_EQ(frames("1", "1"), "/cameras/0/path/1/frame: 1 does not come after 1, the frame before it");
    EXPECT_EQ(frames("24", "12"), "/cameras/0/path/1/frame: 12 does not come after 24, the frame before it");
    EXPECT_EQ(frames("1", "1.5"), "/cameras/0/path/1/frame: 1.5 is no whole number, as frames are");
    EXPECT_THAT(frames("0", "1e18"), HasSubstr("/cameras/0/path/1/frame: 1e+18 is not between 0 and 999999"));
    EXPECT_THAT(frames("-1", "2"), HasSubstr("/cameras/0/path/0/frame: -1 is not between 0 and 999999"));
    EXPECT_THAT(refusalWith(R"("environment": {})"), HasSubstr("/environment: needs either file or color"));
    EXPECT_THAT(refusalWith(R"("environment": {"file": "t.obj"})"),
                HasSubstr("ends neither in .exr nor in .hdr"));
    EXPECT_THAT(refusalWith(R"("background": -1)"), HasSubstr("/background: -1 is below 0"));
    write("inner.scene.json", R"({"models": [{"file": "t.obj"}]})");
    EXPECT_THAT(refusal(R"({"models": [{"file": "inner.scene.json", "units": "m"}]})"),
                HasSubstr("/models/0: units and upAxis are for models"));
}

} // namespace
} // namespace rt

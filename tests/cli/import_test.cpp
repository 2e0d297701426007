// rt-import as its users meet it: exit codes, one line of error, whole outputs or none.
#include "tests/support/read_text.h"
#include "tests/support/run_command.h"
#include "tests/support/scenes.h"
#include "tests/support/temporary_folder.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>
#include <fstream>

namespace rt {
namespace {

using test::CommandResult;
using testing::EndsWith;
using testing::HasSubstr;
using testing::StartsWith;

const char* const kTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

class ImportCli : public testing::Test {
protected:
    std::string write(const std::string& name, const std::string& content) const {
        std::ofstream(folder_.file(name), std::ios::binary) << content;
        return folder_.file(name);
    }
    static CommandResult run(std::vector<std::string> arguments) {
        arguments.insert(arguments.begin(), RT_BIN_DIR "/rt-import");
        return test::runCommand(arguments);
    }
    void expectRefusal(const std::string& model, int exitCode, const std::string& reason) const {
        const std::size_t entries = folder_.entryCount();
        const CommandResult result =
            run({model, "-o", folder_.file("out.rtmesh"), "--json", folder_.file("out.json")});
        EXPECT_EQ(result.exitCode, exitCode);
        EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
        EXPECT_THAT(result.err, StartsWith("rt-import: error: " + model));
        EXPECT_THAT(result.err, HasSubstr(reason));
        EXPECT_EQ(result.out, "");
        EXPECT_EQ(folder_.entryCount(), entries) << "something was left behind";
    }

    test::TemporaryFolder folder_;
};

TEST_F(ImportCli, WritesMeshReportAndDependencies) {
    const std::string mesh = folder_.file("pool.rtmesh"), json = folder_.file("pool.json"),
                      deps = folder_.file("pool.d");
    const CommandResult result = run({test::poolTablePath(), "-o", mesh, "--json", json, "--depfile", deps});
    EXPECT_EQ(result.exitCode, 0);
    EXPECT_THAT(result.err, HasSubstr("56576 triangles"));
    EXPECT_THAT(result.err, HasSubstr("faces without area: 608 dropped (first: face 2, 3, 6, 7, 10 of mesh "
                                      "'tableBed.001_Plane.003')"));
    EXPECT_THAT(test::readText(mesh), StartsWith("\x89RTMESH\n"));
    EXPECT_THAT(test::readText(deps), StartsWith(mesh + ": "));
    EXPECT_THAT(test::readText(deps), HasSubstr("poolTable.mtl"));
    EXPECT_THAT(test::readText(deps), HasSubstr("poolCueEnd.png"));
    const nlohmann::json report = nlohmann::json::parse(test::readText(json));
    EXPECT_EQ(report["triangles"], 56576);
    EXPECT_EQ(report["images"], 17);
    EXPECT_TRUE(report["warnings"].empty());
    for (const char* key :
         {"vertices", "weldedVertices", "movedVertices", "materials", "decimatedFrom", "surface", "leftOut",
          "leftOutBytes", "generatedNormals", "stagesMs", "peakMemoryBytes", "bounds"})
        EXPECT_TRUE(report.contains(key)) << key;
    EXPECT_EQ(report["ledger"][0], nlohmann::json::parse(R"({"defect":"noArea","action":"dropped","count":608,
        "first":[{"mesh":"tableBed.001_Plane.003","face":2},{"mesh":"tableBed.001_Plane.003","face":3},
                 {"mesh":"tableBed.001_Plane.003","face":6},{"mesh":"tableBed.001_Plane.003","face":7},
                 {"mesh":"tableBed.001_Plane.003","face":10}]})"));
}

TEST_F(ImportCli, DependsOnTheFolderOfAMissingTextureUnlessAnOutputIsThere) {
    const std::string model = folder_.file("model.obj"), below = folder_.file("below");
    std::filesystem::create_directory(below);
    std::ofstream(model) << "mtllib m.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n";
    std::ofstream(folder_.file("m.mtl")) << "newmtl m\nmap_Kd wood.png\n";
    ASSERT_EQ(run({model, "-o", below + "/m.rtmesh", "--depfile", below + "/d"}).exitCode, 0);
    EXPECT_THAT(test::readText(below + "/d"),
                EndsWith("m.mtl \\\n  " + std::filesystem::path(model).parent_path().string() + "\n"));
    ASSERT_EQ(run({model, "-o", below + "/m.rtmesh", "--depfile", folder_.file("d")}).exitCode, 0);
    EXPECT_THAT(test::readText(folder_.file("d")), EndsWith("m.mtl\n"));
}

TEST_F(ImportCli, SameInputGivesSameBytes) {
    const std::string model = test::poolTablePath();
    ASSERT_EQ(run({model, "-o", folder_.file("a.rtmesh"), "-j", "1", "-q"}).exitCode, 0);
    const CommandResult second = run({model, "-o", "-", "-j", "7", "-q"});
    EXPECT_EQ(second.err, "");
    EXPECT_TRUE(second.out == test::readText(folder_.file("a.rtmesh")));
}

TEST_F(ImportCli, UsageErrorsExitWith2) {
    const std::string model = write("m.obj", kTriangle);
    for (const std::vector<std::string>& arguments :
         {std::vector<std::string>{},
          {model},
          {model, "-o", ""},
          {"-o", "x.rtmesh"},
          {model, "-o", model},
          {model, "-o", folder_.file("./m.obj")},
          {model, "-o", folder_.file("x.rtmesh"), "--json", model},
          {model, "-o", folder_.file("x.rtmesh"), "--json", folder_.file("x.rtmesh")},
          {"-", "-o", folder_.file("x.rtmesh")},
          {model, "-o", "-", "--json", "-"},
          {model, "-o", "-", "--depfile", "d"},
          {model, "-o", folder_.file("x.rtmesh"), "--crease", "200"},
          {model, "-o", folder_.file("x.rtmesh"), "--crease", "nan"},
          {model, "-o", folder_.file("x.rtmesh"), "--weld", "-1"},
          {model, "-o", folder_.file("x.rtmesh"), "--decimate", "0"},
          {model, "-o", folder_.file("x.rtmesh"), "--decimate", "1.5"},
          {model, "-o", folder_.file("x.rtmesh"), "--max-triangles", "0"},
          {model, "-o", folder_.file("x.rtmesh"), "--max-memory", "much"},
          {model, "-o", folder_.file("x.rtmesh"), "--max-time", "0"},
          {model, "-o", folder_.file("x.rtmesh"), "--allow-format", "bogus"},
          {model, "-o", folder_.file("x.rtmesh"), "--bogus"}}) {
        const CommandResult result = run(arguments);
        EXPECT_EQ(result.exitCode, 2) << result.err;
        EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    }
    EXPECT_EQ(test::readText(model), kTriangle);
    EXPECT_EQ(folder_.entryCount(), 1u);
}

TEST_F(ImportCli, OutputsDoNotReplaceTheModelsOtherFiles) {
    const std::string library = write("m.mtl", "newmtl m\n");
    const std::string model = write("m.obj", std::string("mtllib m.mtl\nusemtl m\n") + kTriangle);
    const CommandResult result = run({model, "-o", library});
    EXPECT_EQ(result.exitCode, 2);
    EXPECT_THAT(result.err, HasSubstr("m.mtl is an input and an output"));
    EXPECT_EQ(test::readText(library), "newmtl m\n");
}

TEST_F(ImportCli, AReportThatCannotBeWrittenLeavesNoMeshEither) {
    const std::string model = write("m.obj", kTriangle);
    EXPECT_EQ(run({model, "-o", folder_.file("x.rtmesh"), "--json", folder_.file("no/x.json")}).exitCode, 3);
    for (const char* option :
         {"--json", "--depfile"}) { // in /proc, which even root can only find out by trying
        const CommandResult result = run({model, "-o", folder_.file("x.rtmesh"), option, "/proc/x.json"});
        EXPECT_EQ(result.exitCode, 3);
        EXPECT_THAT(result.err, HasSubstr("/proc/x.json"));
        EXPECT_EQ(folder_.entryCount(), 1u);
    }
}

TEST_F(ImportCli, UnreadableFilesExitWith3) {
    expectRefusal(folder_.file("missing.obj"), 3, "No such file");
    std::filesystem::create_directory(folder_.file("folder.obj"));
    expectRefusal(folder_.file("folder.obj"), 3, "is a directory");
    const std::string model = write("m.obj", kTriangle);
    EXPECT_EQ(run({model, "-o", folder_.file("no/such/folder.rtmesh")}).exitCode, 3);
}

TEST_F(ImportCli, ContentThatIsNoModelExitsWith4) {
    expectRefusal(write("empty.ply", ""), 4, "is empty");
    expectRefusal(write("model.xyz", kTriangle), 4, "obj, ply, stl, gltf, glb, fbx, 3ds, dae, off");
    expectRefusal(write("none", kTriangle), 4, "extension ''");
    const std::string jpeg =
        "\xff\xd8\xff\xe0" + std::string("\0\x10JFIF\0\1\1\0\0\1\0\1\0\0", 16) + std::string(400, '\x81');
    for (const char* name : {"jpeg.obj", "jpeg.ply", "jpeg.stl", "jpeg.gltf", "jpeg.glb", "jpeg.3ds"})
        expectRefusal(write(name, jpeg), 4, "");
    expectRefusal(write("nan.obj", "v 0 0 0\nv 1 nan 0\nv 0 1 0\nf 1 2 3\n"), 4,
                  "has no triangles (faces with vertices that are not finite: 1 dropped");
    expectRefusal(write("points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\np 1 2 3\n"), 4, "no triangles");
    expectRefusal(write("range.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 30\n"), 4,
                  "cannot be read as a model");
}

TEST_F(ImportCli, ADamagedModelThatCrashesItsLoaderExitsWith4) {
#ifdef __SANITIZE_ADDRESS__
    GTEST_SKIP() << "the sanitizer takes the signal";
#endif
    for (const char* file : {"invalid__crash-30d6d0f7c529b3b66b4131700b7a4580cd7082df.ply",
                             "PLY__cube_binary_starts_with_nl.ply"}) {
        const std::string path = test::scenePath(std::string("broken/assimp/") + file);
        if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is absent";
        expectRefusal(write("damaged.ply", test::readText(path)), 4, "");
    }
}

TEST_F(ImportCli, OtherFormatsAreReadWhenAllowed) {
    const std::string raw = write("m.RAW", "0 0 0 1 0 0 0 1 0\n0 0 1 1 0 1 0 1 1\n");
    expectRefusal(raw, 4, "--allow-format");
    const CommandResult result = run({raw, "-o", folder_.file("x.rtmesh"), "--allow-format", "raw"});
    EXPECT_EQ(result.exitCode, 0) << result.err;
    EXPECT_THAT(result.err, HasSubstr("2 triangles"));
    const CommandResult list = run({"--list-formats"});
    EXPECT_EQ(list.exitCode, 0);
    EXPECT_THAT(list.out, testing::ContainsRegex("fbx +read +Autodesk FBX"));
    EXPECT_THAT(list.out, testing::ContainsRegex("raw +--allow-format +Raw"));
}

TEST_F(ImportCli, StrictRefusesWhatHadToBeRepaired) {
    const std::string model = write("m.obj", std::string(kTriangle) + "f 1 2 2\n");
    const CommandResult result = run({model, "-o", folder_.file("x.rtmesh"), "--strict"});
    EXPECT_EQ(result.exitCode, 4);
    EXPECT_THAT(result.err, StartsWith("rt-import: error: " + model + ": faces without area: 1 dropped"));
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_EQ(folder_.entryCount(), 1u);
    EXPECT_EQ(run({write("n.obj", kTriangle), "-o", folder_.file("x.rtmesh"), "--strict"}).exitCode, 0);
}

TEST_F(ImportCli, DecimatesToWhatIsAsked) {
    const std::string mesh = folder_.file("p.rtmesh"), json = folder_.file("p.json");
    const CommandResult result =
        run({test::poolTablePath(), "-o", mesh, "--json", json, "--max-triangles", "40000", "-v"});
    EXPECT_EQ(result.exitCode, 0) << result.err;
    EXPECT_THAT(result.err, HasSubstr("decimated from 56628 triangles"));
    const nlohmann::json report = nlohmann::json::parse(test::readText(json));
    EXPECT_LE(report["triangles"], 40000);
    EXPECT_GE(report["triangles"], 39000);
    EXPECT_EQ(run({test::poolTablePath(), "-o", mesh, "--max-triangles", "100", "-q"}).exitCode, 5);
}

TEST_F(ImportCli, LimitsExitWith5) {
    for (const std::vector<std::string>& limit :
         {std::vector<std::string>{"--max-time", "0.001"}, {"--max-memory", "40M"}}) {
#ifdef __SANITIZE_ADDRESS__
        if (limit[0] == "--max-memory") continue;
#endif
        const CommandResult result =
            run({test::poolTablePath(), "-o", folder_.file("x.rtmesh"), limit[0], limit[1]});
        EXPECT_EQ(result.exitCode, 5) << result.err;
        EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
        EXPECT_EQ(folder_.entryCount(), 0u);
    }
}

TEST_F(ImportCli, NamesOnTheTerminalHoldNoControlCharacters) {
    const std::string model = write("m.obj", std::string("o a\x1b[31mb\n") + kTriangle + "f 1 2 2\n");
    const CommandResult result = run({model, "-o", folder_.file("x.rtmesh")});
    EXPECT_THAT(result.err, HasSubstr("of mesh 'a [31mb'"));
}

TEST_F(ImportCli, OversizedTextureExitsWith5) {
    write("m.mtl", "newmtl m\nmap_Kd wide.ppm\n");
    write("wide.ppm", "P6\n1 99999\n255\n");
    const std::string model = write("m.obj", std::string("mtllib m.mtl\nusemtl m\n") + kTriangle);
    const CommandResult result = run({model, "-o", folder_.file("out.rtmesh")});
    EXPECT_EQ(result.exitCode, 5);
    EXPECT_THAT(result.err, HasSubstr("exceeds 16384"));
    EXPECT_EQ(folder_.entryCount(), 3u);
}

TEST_F(ImportCli, AnImageThatMemoryDoesNotSufficeForIsNamed) {
#ifdef __SANITIZE_ADDRESS__
    GTEST_SKIP() << "the sanitizer needs the address space";
#endif
    write("m.mtl", "newmtl m\nmap_Kd huge.bmp\n");
    const std::string model = write("m.obj", std::string("mtllib m.mtl\nusemtl m\n") + kTriangle);
    std::string bmp("BM\0\0\0\0\0\0\0\0\x36\0\0\0\x28\0\0\0\0\x40\0\0\0\x40\0\0\1\0\x18\0", 30);
    bmp.resize(54, '\0');
    write("huge.bmp", bmp); // 16384 x 16384 pixels, of which there are none
    const CommandResult result = run({model, "-o", folder_.file("out.rtmesh"), "--max-memory", "600M"});
    EXPECT_EQ(result.exitCode, 5);
    EXPECT_THAT(result.err, HasSubstr("huge.bmp: memory does not suffice to decode this image of 16384x16384 "
                                      "pixels (54 bytes as a file); raise --max-memory"));
    EXPECT_EQ(folder_.entryCount(), 3u);
}

TEST_F(ImportCli, APlyFileCutInItsHeaderIsRefusedAtOnce) {
    expectRefusal(write("m.ply", "ply\nformat ascii 1.0\nelement vertex 3\n"), 4,
                  "its header has no line 'end_header'");
}

TEST_F(ImportCli, AModelThatMemoryDoesNotSufficeForIsALimit) {
#ifdef __SANITIZE_ADDRESS__
    GTEST_SKIP() << "the sanitizer needs the address space";
#endif
    const std::string model = write("m.ply", "ply\n");
    std::filesystem::resize_file(model, 64u << 20); // a hole
    const CommandResult result = run({model, "-o", folder_.file("out.rtmesh"), "--max-memory", "40M"});
    EXPECT_EQ(result.exitCode, 5);
    EXPECT_THAT(result.err,
                HasSubstr("m.ply: memory does not suffice to map its 67108864 bytes; raise --max-memory"));
}

// A width and a height that its bytes cannot hold need no memory to be seen through.
TEST_F(ImportCli, ADamagedPngThatClaimsManyPixelsIsAWarning) {
    write("m.mtl", "newmtl m\nmap_Kd huge.png\n");
    const std::string model = write("m.obj", std::string("mtllib m.mtl\nusemtl m\n") + kTriangle);
    const std::string header("\x89PNG\r\n\x1a\n\0\0\0\x0dIHDR\0\0\x40\0\0\0\x40\0\x08\x06\0\0\0\0\0\0\0", 33);
    write("huge.png", header + std::string("\0\0\0\x04IDAT\x78\x9c\x01\x02\0\0\0\0", 16) +
                          std::string("\0\0\0\0IEND\0\0\0\0", 12));
    const CommandResult result = run({model, "-o", folder_.file("out.rtmesh"), "--max-memory", "600M"});
    EXPECT_EQ(result.exitCode, 0);
    EXPECT_THAT(result.err, HasSubstr("huge.png"));
    EXPECT_THAT(result.err,
                HasSubstr("cannot be decoded: a PNG of 61 bytes, cut short, damaged or of a rare kind"));
}

TEST_F(ImportCli, WarningsNameTheirFileOnce) {
    const std::string other = write("b.obj", kTriangle);
    const std::string model = write("a.obj", std::string("usemtl gone\n") + kTriangle);
    const std::string scene = write("a.scene.json", R"({"background":[1,0,0],"models":[{"file":"b.obj"}]})"),
                      second = write("b.scene.json", R"({"background":[1,0,0]})");
    const std::string out = folder_.file("x.rtmesh"), begin = "rt-import: warning: ";
    EXPECT_THAT(run({other, model, "-o", out}).err, HasSubstr(begin + model + ": no material library"));
    EXPECT_THAT(run({model, "-o", out}).err, HasSubstr(begin + model + ": no material library"));
    EXPECT_THAT(run({scene, second, "-o", out}).err,
                HasSubstr(begin + second + ": /background: another background counts"));
    EXPECT_THAT(
        run({scene, second, "-o", out, "--strict"}).err,
        HasSubstr("rt-import: error: " + second + ": /background: another background counts; --strict"));
}

TEST_F(ImportCli, VersionNamesTheLibraries) {
    const CommandResult result = run({"--version"});
    EXPECT_EQ(result.exitCode, 0);
    EXPECT_THAT(result.out, HasSubstr("Assimp 5."));
    EXPECT_THAT(result.out, HasSubstr("OpenMesh"));
}

} // namespace
} // namespace rt

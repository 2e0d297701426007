#pragma once
#include "formats/image_exr.h"
#include "formats/mesh_file.h"
#include "tests/support/make_mesh.h"
#include "tests/support/read_text.h"
#include "tests/support/run_command.h"
#include "tests/support/temporary_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <memory>

namespace rt::test {

inline NamedCamera cameraNamed(const std::string& name, std::uint32_t kind, double z) {
    NamedCamera camera{};
    name.copy(camera.name, sizeof camera.name - 1);
    camera.eye[2] = z;
    camera.up[1] = 1.0;
    camera.fovDegrees = kind == kCameraPerspective ? 30.0 : 0.0;
    camera.height = kind == kCameraOrthographic ? 4.0 : 0.0;
    camera.kind = kind;
    return camera;
}

/// rt-trace on a sphere of two materials, with two cameras.
class PictureCommand : public testing::Test {
protected:
    static void SetUpTestSuite() {
        folder = std::make_unique<TemporaryFolder>();
        Mesh mesh = makeSphere(3);
        mesh.materials = std::vector<Material>(2, mesh.materials[0]);
        std::vector<std::uint32_t> triangleMaterial(mesh.triangles.size());
        for (std::uint32_t i = 0; i < triangleMaterial.size(); ++i) triangleMaterial[i] = i % 2;
        mesh.triangleMaterial = std::move(triangleMaterial);
        mesh.cameras = std::vector<NamedCamera>{cameraNamed("front", kCameraPerspective, 5.0),
                                                cameraNamed("plan view", kCameraOrthographic, 8.0)};
        writeMesh(folder->file("s.rtmesh"), mesh);
        const CommandResult grid =
            runCommand({RT_BIN_DIR "/rt-grid", folder->file("s.rtmesh"), "-o", folder->file("s.rtatlas")});
        ASSERT_EQ(grid.exitCode, 0) << grid.err;
    }
    static void TearDownTestSuite() { folder.reset(); }

    CommandResult trace(std::vector<std::string> arguments) const {
        arguments.insert(arguments.begin(), {RT_BIN_DIR "/rt-trace", folder->file("s.rtatlas")});
        return runCommand(arguments);
    }
    // Renders 64x64 pixels to an EXR, which comes back.
    Image render(const std::string& name, std::vector<std::string> arguments) const {
        arguments.insert(arguments.begin(), {"-o", out.file(name), "--size", "64x64", "--reproducible"});
        const CommandResult result = trace(arguments);
        EXPECT_EQ(result.exitCode, 0) << result.err;
        return readExr(out.file(name));
    }
    nlohmann::json figures(std::vector<std::string> arguments) const {
        arguments.insert(arguments.begin(), {"-o", out.file("j.exr"), "--json", out.file("j.json")});
        const CommandResult result = trace(arguments);
        EXPECT_EQ(result.exitCode, 0) << result.err;
        return nlohmann::json::parse(readText(out.file("j.json")));
    }
    void expectUsage(std::vector<std::string> arguments, const std::string& message) const {
        arguments.insert(arguments.begin(), {"-o", out.file("usage.exr")});
        const CommandResult result = trace(arguments);
        EXPECT_EQ(result.exitCode, 2) << result.err;
        EXPECT_THAT(result.err, testing::HasSubstr(message));
        EXPECT_FALSE(std::filesystem::exists(out.file("usage.exr")));
    }
    std::string bytesOf(const std::string& name) const { return readText(out.file(name)); }

    inline static std::unique_ptr<TemporaryFolder> folder;
    TemporaryFolder out;
};

} // namespace rt::test

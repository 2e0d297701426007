// Where textures are found, where they are not looked for, and pictures in floating point.
#include "formats/image_exr.h"
#include "tests/unit/import_files.h"
#include "tools/rt-import/model_folder.h"

#include <gmock/gmock.h>

#include <filesystem>

namespace rt {
namespace {

using test::ModelFiles;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Optional;

class Folders : public testing::Test, public ModelFiles {
protected:
    std::optional<std::string> find(const std::string& name,
                                    const std::vector<std::string>& roots = {}) const {
        std::vector<std::string> others;
        for (const std::string& root : roots) others.push_back(path(root));
        return ModelFolder(path("scene/model/m.obj"), others).find(name);
    }
};

TEST_F(Folders, NamesAreFoundAsPeopleExpect) {
    write("scene/model/Textures/Wood 1.PNG", "");
    const std::string wood = path("scene/model/Textures/Wood 1.PNG");
    for (const char* name : {"Textures/Wood 1.PNG", "textures\\wood 1.png", ".\\TEXTURES/./x/../wood 1.png",
                             "textures/wood%201.png", "C:\\Users\\somebody\\project\\textures\\wood 1.png",
                             "/home/somebody/textures/wood 1.png", "file:///C:/project/textures/wood%201.png",
                             "../../project/textures/wood 1.png"})
        EXPECT_THAT(find(name), Optional(wood)) << name;
    write("scene/model/wood 1.png", "");
    EXPECT_THAT(find("D:\\other\\wood 1.png"), Optional(path("scene/model/wood 1.png")));
    EXPECT_THAT(find("D:\\textures\\wood 1.png"), Optional(wood)) << "more of its end counts first";
    for (const char* name : {"", ".", "..", "/", "textures", "textures/", "wood 2.png", "*", "wood 1.png/x"})
        EXPECT_EQ(find(name), std::nullopt) << name;
}

TEST_F(Folders, OnlyNamedFoldersAreLookedInto) {
    write("scene/model/m.obj", "");
    write("scene/wood.png", "");
    write("elsewhere/sub/brick.png", "");
    EXPECT_EQ(find("../wood.png"), std::nullopt);
    EXPECT_THAT(find("../wood.png", {"scene"}), Optional(HasSubstr("/scene/wood.png")));
    EXPECT_THAT(find("wood.png", {"scene"}), Optional(path("scene/wood.png")));
    EXPECT_EQ(find("../../elsewhere/sub/brick.png", {"scene"}), std::nullopt);
    EXPECT_EQ(find(path("elsewhere/sub/brick.png")), std::nullopt) << "an absolute path that there is";
    EXPECT_THAT(find("X:/a/SUB/brick.png", {"scene", "elsewhere"}),
                Optional(path("elsewhere/sub/brick.png")));
}

TEST_F(Folders, LinksMayNotLeadOut) {
    write("scene/model/in.png", "");
    write("secret/key.png", "");
    const auto link = [&](const std::string& to, const std::string& name) {
        std::filesystem::create_symlink(path(to), path("scene/model/" + name));
    };
    link("scene/model/in.png", "same.png");
    link("secret/key.png", "out.png");
    link("secret", "folder");
    EXPECT_THAT(find("same.png"), Optional(path("scene/model/same.png")));
    EXPECT_EQ(find("out.png"), std::nullopt);
    EXPECT_EQ(find("folder/key.png"), std::nullopt);
    EXPECT_THAT(find("out.png", {"secret"}), Optional(path("scene/model/out.png")));
}

class FloatTextures : public testing::Test, public ModelFiles {
protected:
    // An EXR of one row: the colours, and alpha unless it is empty.
    void writeExr(const std::string& name, const std::vector<glm::vec3>& colors,
                  const std::vector<float>& alpha) const {
        Image image;
        image.width = static_cast<std::uint32_t>(colors.size());
        image.height = 1;
        if (!alpha.empty()) image.channels.push_back({"A", ImageChannel::Type::Float, alpha, {}});
        for (int c = 2; c >= 0; --c) {
            ImageChannel channel{std::string(1, "RGB"[c]), ImageChannel::Type::Float, {}, {}};
            for (const glm::vec3& color : colors) channel.values.push_back(color[c]);
            image.channels.push_back(channel);
        }
        const std::vector<std::byte> bytes = encodeExr(image);
        write(name, std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
    }
    Mesh importMaterial(const std::string& lines) const {
        write("m.mtl", "newmtl m\n" + lines);
        write("m.obj",
              "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl m\nf 1/1 2/2 3/3\n");
        const ImportedModel model = import("m.obj");
        warnings = model.report.warnings;
        return model.mesh;
    }
    static std::vector<std::uint32_t> pixels(const Mesh& mesh) {
        return {mesh.pixels.begin(), mesh.pixels.end()};
    }

    mutable std::vector<std::string> warnings;
};

TEST_F(FloatTextures, ColoursAreEncodedAndClamped) {
    writeExr("c.exr", {{0.2158605f, 1.0f, 7.0f}, {-1.0f, 0.0f, NAN}}, {});
    const Mesh mesh = importMaterial("Kd 1 1 1\nmap_Kd c.exr\n");
    EXPECT_THAT(pixels(mesh), ElementsAre(0xFFFFFF80u, 0xFF000000u)); // 0.2158605 is 128 in sRGB
    EXPECT_EQ(mesh.images[0].space, kImageSrgb);
    EXPECT_EQ(mesh.materials[0].baseColor, glm::vec4(1.0f));
}

TEST_F(FloatTextures, EmissionKeepsItsRange) {
    writeExr("e.exr", {{8.0f, 4.0f, 0.0f}, {INFINITY, 0.0f, 0.0f}}, {});
    EXPECT_EQ(importMaterial("Ke 2 1 1\nmap_Ke e.exr\n").materials[0].emission,
              glm::vec4(131008, 65504, 65504, 0));
    writeExr("e.exr", {{8.0f, 8.0f * 0.2158605f, 0.0f}}, {});
    const Mesh mesh = importMaterial("Ke 2 1 1\nmap_Ke e.exr\nmap_Kd e.exr\n");
    EXPECT_EQ(mesh.materials[0].emission, glm::vec4(16, 8, 8, 0));
    EXPECT_THAT(pixels(mesh), testing::UnorderedElementsAre(0xFF0080FFu, 0xFF00FFFFu))
        << "as light and as colour";
    writeExr("e.exr", {{0.5f, 0.25f, 0.0f}}, {});
    EXPECT_EQ(importMaterial("Ke 2 1 1\nmap_Ke e.exr\n").materials[0].emission, glm::vec4(2, 1, 1, 0));
}

TEST_F(FloatTextures, AlphaIsTakenOutOfTheColours) {
    writeExr("c.exr", {{0.25f, 0.5f, 0.0f}}, {0.5f});
    const Mesh mesh = importMaterial("map_Kd c.exr\nmap_d c.exr\n");
    EXPECT_THAT(pixels(mesh), ElementsAre(0x8000FFBCu)); // 0.5 is 188 in sRGB
}

TEST_F(FloatTextures, NumbersStayNumbers) {
    writeExr("n.exr", {{0.5f, 0.5f, 1.0f}}, {});
    const Mesh mesh = importMaterial("norm n.exr\n");
    EXPECT_THAT(pixels(mesh), ElementsAre(0xFFFF8080u));
    EXPECT_EQ(mesh.images[0].space, kImageLinear);
}

TEST_F(FloatTextures, RadianceIsReadByItsContent) {
    write("c.png", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 1\n\x80\x40\x20\x82");
    const Mesh mesh = importMaterial("Ke 1 1 1\nmap_Ke c.png\n");
    EXPECT_THAT(warnings, IsEmpty());
    EXPECT_EQ(mesh.materials[0].emission, glm::vec4(2, 2, 2, 0)); // 0x80 * 2^(0x82 - 136) = 2
    EXPECT_THAT(pixels(mesh), ElementsAre(0xFF89BCFFu));
}

TEST_F(FloatTextures, OnesInsideTheModelAreReadToo) {
    // The picture of the test above, in base 64.
    const std::string material = R"({"emissiveFactor":[1,1,1],"emissiveTexture":{"index":0}})";
    write("m.gltf", test::gltfTriangle(*this, {0, 0, 1}, R"({"mesh":0})", material,
                                       R"(,"textures":[{"source":0}],"images":[{"mimeType":"image/png",
        "uri":"data:image/png;base64,Iz9SQURJQU5DRQpGT1JNQVQ9MzItYml0X3JsZV9yZ2JlCgotWSAxICtYIDEKgEAggg=="}])"));
    const ImportedModel model = import("m.gltf");
    EXPECT_THAT(model.report.warnings, IsEmpty());
    EXPECT_EQ(model.mesh.materials[0].emission, glm::vec4(2, 2, 2, 0));
    EXPECT_THAT(pixels(model.mesh), ElementsAre(0xFF89BCFFu));
}

TEST_F(FloatTextures, DamageIsAWarning) {
    writeExr("c.exr", {glm::vec3(1.0f)}, {});
    std::filesystem::resize_file(path("c.exr"), 60);
    const Mesh mesh = importMaterial("Kd 0.5 0.5 0.5\nmap_Kd c.exr\n");
    EXPECT_THAT(warnings, ElementsAre(HasSubstr("texture 'c.exr' cannot be decoded")));
    EXPECT_EQ(mesh.materials[0].baseColor, glm::vec4(0.5f, 0.5f, 0.5f, 1.0f));
    EXPECT_TRUE(mesh.images.empty());
}

TEST_F(FloatTextures, AnImageThatIsCutShortIsNamedWithItsSize) {
    const std::string png("\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0\x40\0\0\0\x40\x08\x02\0\0\0", 29);
    write("c.png", png);
    importMaterial("map_Kd c.png\n");
    EXPECT_THAT(warnings,
                ElementsAre(HasSubstr("texture 'c.png' cannot be decoded: a PNG of 29 bytes, cut short")));
    write("c.png", "these are words");
    importMaterial("map_Kd c.png\n");
    EXPECT_THAT(warnings,
                ElementsAre(HasSubstr("texture 'c.png' cannot be decoded: 15 bytes of no known kind")));
}

} // namespace
} // namespace rt

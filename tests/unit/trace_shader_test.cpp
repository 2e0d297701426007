// How rt-trace puts its shaders together.
#include "common/error.h"
#include "tests/support/make_mesh.h"
#include "tools/rt-trace/scene_features.h"
#include "tools/rt-trace/shader_resources.h"
#include "tools/rt-trace/shader_source.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <sstream>

namespace rt {
namespace {

using testing::HasSubstr;
using testing::Not;

ShaderFinder finderOf(const std::map<std::string, std::string, std::less<>>& files) {
    return [files](std::string_view path) -> std::optional<std::string> {
        const auto found = files.find(path);
        return found == files.end() ? std::nullopt : std::optional(found->second);
    };
}

TEST(ShaderSource, IncludesEachFileOnceAndKeepsTrackOfLines) {
    const auto find = finderOf({{"main", "one\n#include \"a\"\nthree\n#include \"b\"\n"},
                                {"a", "#include \"b\"\nin a\n"},
                                {"b", "in b\n"}});
    const ShaderText shader = composeShader("#version 450\n", "main", find);
    EXPECT_EQ(shader.text,
              "#version 450\n#line 1 1\none\n#line 1 2\n#line 1 3\nin b\n#line 2 2\nin a\n#line 3 1\nthree\n"
              "#line 5 1\n");
    EXPECT_EQ(shader.files, (std::vector<std::string>{"prelude", "main", "a", "b"}));
}

TEST(ShaderSource, LeavesOutWhatIsForCppAndWhatThatIncludes) {
    const auto find =
        finderOf({{"main", "#ifdef __cplusplus\n#include \"b\"\n#if X\ncpp\n#endif\n#else\nglsl\n#endif\n"
                           "#ifndef __cplusplus\nalso glsl\n#else\nalso cpp\n#endif\n#include \"b\"\n"},
                  {"b", "in b\n"}});
    const std::string text = composeShader("", "main", find).text;
    EXPECT_THAT(text, Not(HasSubstr("cpp\n")));
    EXPECT_THAT(text, HasSubstr("\nglsl\n"));
    EXPECT_THAT(text, HasSubstr("also glsl\n"));
    EXPECT_THAT(text, HasSubstr("#line 1 2\nin b\n"));
    EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1 + 13 + 3); // each line of main keeps its place
}

TEST(ShaderSource, AnUnknownIncludeIsAnInternalError) {
    EXPECT_THROW(composeShader("", "main", finderOf({{"main", "#include \"nowhere\"\n"}})), Error);
}

TEST(ShaderSource, CompilerLogsNameFiles) {
    const ShaderText shader{"", {"prelude", "shaders/a.glsl"}};
    EXPECT_EQ(nameFiles("1:17(3): error: x\n1(5) : error C1\n9:1: y\nno place\n", shader),
              "shaders/a.glsl:17(3): error: x\nshaders/a.glsl(5) : error C1\n9:1: y\nno place\n");
}

TEST(ShaderSource, EveryShaderOfTheRepositoryIsEmbedded) {
    for (const char* path : {"shaders/trace.comp.glsl", "shaders/shade.comp.glsl", "shaders/query.comp.glsl",
                             "formats/atlas.shared.h"}) {
        std::ostringstream text;
        text << std::ifstream(std::string(RT_SOURCE_DIR "/") + path).rdbuf();
        EXPECT_EQ(embeddedShader(path), text.str()) << path;
    }
    EXPECT_EQ(embeddedShader("shaders/nothing.glsl"), std::nullopt);
}

// Second words of the lines that begin with `first`.
std::vector<std::string> secondWords(const std::string& text, const std::string& first) {
    std::vector<std::string> words;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
        std::istringstream inLine(line);
        std::string head, word;
        if (inLine >> head >> word && head == first) words.push_back(word);
    }
    return words;
}

TEST(SceneFeatures, TheTableAndTheShadersNameTheSameMacros) {
    const std::string shader = embeddedShader("shaders/features.glsl").value();
    std::vector<std::string> macros;
    for (const FeatureRow& row : featureTable()) {
        macros.push_back(row.macro);
        // Beside the two lines of its #error, a macro stands in the definition of its constant.
        const std::string definition = shader.substr(shader.rfind("#endif"));
        EXPECT_THAT(definition, HasSubstr(row.macro));
    }
    EXPECT_EQ(secondWords(shader, "#ifndef"), macros);
    EXPECT_EQ(secondWords(featureDefines({}), "#define"), macros);
}

// Triangle 0 uses material 0; nothing uses material 1.
Atlas atlasWithMaterials(const Material& used, const Material& unused) {
    Atlas atlas;
    atlas.grid.dims = glm::uvec4(1, 1, 1, kStructureCloud);
    atlas.materials = std::vector<Material>{used, unused};
    atlas.triangleVertices = std::vector<glm::uvec4>{{0, 0, 0, 0}};
    return atlas;
}

TEST(SceneFeatures, AMaterialCountsOnlyIfATriangleUsesIt) {
    const Material plain = diffuseMaterial(glm::vec3(1.0f));
    Material rich = plain;
    rich.emission.y = 1.0f;
    rich.reflection.w = 0.5f;
    rich.transmission.x = 0.5f;
    rich.images.x = 0;
    const SceneFeatures none = renderFeatures(atlasWithMaterials(plain, rich), {.maxDepth = 4});
    EXPECT_EQ(none.structure, kStructureCloud);
    for (const FeatureRow& row : featureTable())
        EXPECT_EQ(none.*row.field, row.field == &SceneFeatures::structure ? kStructureCloud : 0u)
            << row.macro;
    const SceneFeatures all =
        renderFeatures(atlasWithMaterials(rich, plain), {.maxDepth = 4, .lights = test::kTwoLights});
    EXPECT_TRUE(all.hasTextures && all.hasReflection && all.hasTransmission && all.hasEmission &&
                all.lightCount == 2);
    EXPECT_EQ(all.maxDepth, 4u);
    const SceneFeatures flat =
        renderFeatures(atlasWithMaterials(rich, plain), {.maxDepth = 0, .lights = test::kTwoLights});
    EXPECT_FALSE(flat.hasReflection || flat.hasTransmission);
    EXPECT_TRUE(flat.hasTextures);
}

TEST(SceneFeatures, OneMarkedTriangleMakesASceneOfSlivers) {
    for (const std::size_t marked : {0u, 20'000u, 39'999u}) { // more than one thread's share
        Atlas atlas;
        std::vector<TriangleRecord> triangles(40'000);
        atlas.triangles = std::vector<TriangleRecord>(triangles);
        EXPECT_EQ(queryFeatures(atlas, false).hasSlivers, 0u);
        EXPECT_EQ(renderFeatures(atlas, {.maxDepth = 0}).hasSlivers, 0u);
        triangles[marked].v1.w = 1.0f;
        atlas.triangles = std::move(triangles);
        EXPECT_EQ(queryFeatures(atlas, false).hasSlivers, 1u) << marked;
        EXPECT_EQ(renderFeatures(atlas, {.maxDepth = 0}).hasSlivers, 1u) << marked;
    }
}

constexpr ResourceLimits kRoomy{1 << 20, 16, 16, 256, 1 << 20, 16};

Atlas atlasOf(std::size_t references, glm::uvec3 dims) {
    Atlas atlas;
    atlas.grid.dims = glm::uvec4(dims, kStructureUniform);
    atlas.references = std::vector<std::uint32_t>(references);
    atlas.triangles = std::vector<TriangleRecord>(10);
    return atlas;
}

ResourcePlan planQuery(const Atlas& atlas, const ResourceLimits& limits) {
    return planResources(atlas, {}, ShaderKind::Query, limits, "x.rtatlas");
}

TEST(ShaderResources, WhatFitsIsReadPlainly) {
    const std::string text = resourceText(planQuery(atlasOf(100, {4, 4, 4}), kRoomy));
    EXPECT_THAT(text, HasSubstr("uint loadReference(uint i) {\n    return references0[i];\n}"));
    EXPECT_THAT(text, HasSubstr("uint loadVoxel(ivec3 c) {\n    return texelFetch(voxels0, c, 0).x;\n}"));
    EXPECT_THAT(text,
                HasSubstr("binding = 6) readonly restrict buffer referencesBlock0 { uint references0[]; };"));
    EXPECT_THAT(text, HasSubstr("binding = 7) readonly restrict buffer trianglesBlock0"));
    for (const char* absent : {"switch", "loadTexcoord", "loadNormal", "materials", "colorImage", "counters"})
        EXPECT_THAT(text, Not(HasSubstr(absent)));
}

TEST(ShaderResources, ArraysAreSplitIntoPagesOfAPowerOfTwo) {
    ResourceLimits limits = kRoomy;
    limits.storageBlockBytes = 200; // 50 references, so 32; 4 triangles
    const ResourcePlan plan = planQuery(atlasOf(100, {4, 4, 4}), limits);
    const PagedArray& references = plan.arrays[0];
    EXPECT_EQ(references.pageCount, 4u);
    EXPECT_EQ(references.pageShift, 5u);
    EXPECT_EQ(references.page(0).size(), 128u);
    EXPECT_EQ(references.page(3).size(), 16u);
    EXPECT_EQ(references.page(3).data(), references.bytes.data() + 384);
    EXPECT_EQ(plan.arrays[1].firstBinding, 10u);
    EXPECT_EQ(plan.arrays[1].pageCount, 3u);
    EXPECT_THAT(resourceText(plan), HasSubstr("uint loadReference(uint i) {\n    switch (int(i >> 5)) {\n"
                                              "    case 0: return references0[i & 31u];\n"
                                              "    case 1: return references1[i & 31u];\n"
                                              "    case 2: return references2[i & 31u];\n"
                                              "    default: return references3[i & 31u];\n    }\n}"));
}

TEST(ShaderResources, AnArrayThatJustFitsIsNotSplit) {
    ResourceLimits limits = kRoomy;
    limits.storageBlockBytes = 480;
    EXPECT_EQ(planQuery(atlasOf(120, {4, 4, 4}), limits).arrays[0].pageCount, 1u);
    EXPECT_EQ(planQuery(atlasOf(121, {4, 4, 4}), limits).arrays[0].pageCount, 2u);
}

TEST(ShaderResources, VoxelsAreSplitIntoSlabsAlongZ) {
    ResourceLimits limits = kRoomy;
    limits.textureSize3D = 20;
    const ResourcePlan plan = planQuery(atlasOf(1, {20, 4, 50}), limits);
    EXPECT_EQ(plan.voxels.count, 4u);
    EXPECT_EQ(plan.voxels.layers(0), 16u);
    EXPECT_EQ(plan.voxels.firstLayer(3), 48u);
    EXPECT_EQ(plan.voxels.layers(3), 2u);
    EXPECT_THAT(resourceText(plan),
                HasSubstr("    switch (c.z >> 4) {\n"
                          "    case 0: return texelFetch(voxels0, ivec3(c.xy, c.z & 15), 0).x;\n"));
    limits = kRoomy;
    limits.textureBytes = 20 * 4 * 4 * 10; // ten layers, so 8
    EXPECT_EQ(planQuery(atlasOf(1, {20, 4, 50}), limits).voxels.count, 7u);
}

TEST(ShaderResources, WhatDoesNotFitIsALimitWithAMessage) {
    const auto messageOf = [](const Atlas& atlas, const ResourceLimits& limits) -> std::string {
        try {
            planQuery(atlas, limits);
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::LimitExceeded);
            return error.what();
        }
        return "no error";
    };
    ResourceLimits limits = kRoomy;
    limits.storageBlockBytes = 48;
    EXPECT_THAT(messageOf(atlasOf(100, {4, 4, 4}), limits), HasSubstr("x.rtatlas: needs 25 storage buffers"));
    EXPECT_THAT(messageOf(atlasOf(1, {257, 4, 4}), kRoomy), HasSubstr("allows 256 along x and y"));
    limits = kRoomy;
    limits.textureSize3D = 4;
    EXPECT_THAT(messageOf(atlasOf(1, {4, 4, 64}), limits),
                HasSubstr("needs 16 textures, this device allows 13"));
}

} // namespace
} // namespace rt

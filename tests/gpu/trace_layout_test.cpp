// What C++ and GLSL share: the places of struct members, and the octahedral map.
#include "formats/gpu_interface.shared.h"
#include "formats/material.shared.h"
#include "formats/octahedral.shared.h"
#include "tests/gpu/trace_fixture.h"

#include <epoxy/gl.h>
#include <fmt/format.h>

#include <cstring>
#include <random>

namespace rt {
namespace {

using test::OnGpu;

class SharedLayout : public OnGpu {};

ShaderText compose(const std::string& entry) {
    return composeShader("#version 450 core\n", "entry",
                         [&](std::string_view path) -> std::optional<std::string> {
                             return path == "entry" ? entry : embeddedShader(path);
                         });
}

constexpr const char* kIncludes = "#include \"formats/shared_types.shared.h\"\n"
                                  "#include \"formats/octahedral.shared.h\"\n"
                                  "#include \"formats/material.shared.h\"\n"
                                  "#include \"formats/atlas.shared.h\"\n"
                                  "#include \"formats/gpu_interface.shared.h\"\n"
                                  "layout(local_size_x = 64) in;\n";

struct Member {
    const char* name;
    std::size_t offset;
};
struct SharedStruct {
    const char* type;
    std::size_t size;
    std::vector<Member> members;
};

#define RT_MEMBER(type, member)                                                                              \
    { #member, offsetof(type, member) }

std::vector<SharedStruct> sharedStructs() {
    return {
        {"GridParams",
         sizeof(GridParams),
         {RT_MEMBER(GridParams, gridLo), RT_MEMBER(GridParams, cellSize), RT_MEMBER(GridParams, cellsPerUnit),
          RT_MEMBER(GridParams, worldOffset), RT_MEMBER(GridParams, dims), RT_MEMBER(GridParams, counts)}},
        {"TriangleRecord",
         sizeof(TriangleRecord),
         {RT_MEMBER(TriangleRecord, v0), RT_MEMBER(TriangleRecord, v1), RT_MEMBER(TriangleRecord, v2)}},
        {"Material",
         sizeof(Material),
         {RT_MEMBER(Material, baseColor), RT_MEMBER(Material, emission), RT_MEMBER(Material, reflection),
          RT_MEMBER(Material, transmission), RT_MEMBER(Material, attenuation), RT_MEMBER(Material, images),
          RT_MEMBER(Material, more)}},
        {"Light",
         sizeof(Light),
         {RT_MEMBER(Light, position), RT_MEMBER(Light, intensity), RT_MEMBER(Light, direction),
          RT_MEMBER(Light, edgeU), RT_MEMBER(Light, edgeV), RT_MEMBER(Light, kind)}},
        {"ImagePlace", sizeof(ImagePlace), {RT_MEMBER(ImagePlace, rect), RT_MEMBER(ImagePlace, page)}},
        {"CameraParams",
         sizeof(CameraParams),
         {RT_MEMBER(CameraParams, eye), RT_MEMBER(CameraParams, right), RT_MEMBER(CameraParams, up),
          RT_MEMBER(CameraParams, forward)}},
        {"RenderParams",
         sizeof(RenderParams),
         {RT_MEMBER(RenderParams, background), RT_MEMBER(RenderParams, ambient),
          RT_MEMBER(RenderParams, environment), RT_MEMBER(RenderParams, filterSize),
          RT_MEMBER(RenderParams, size), RT_MEMBER(RenderParams, region), RT_MEMBER(RenderParams, samples)}},
        {"QueryParams", sizeof(QueryParams), {RT_MEMBER(QueryParams, count)}},
        {"QueryRay", sizeof(QueryRay), {RT_MEMBER(QueryRay, originTmin), RT_MEMBER(QueryRay, directionTmax)}},
        {"QueryHit", sizeof(QueryHit), {RT_MEMBER(QueryHit, tuvId)}},
        {"TriangleTransform",
         sizeof(TriangleTransform),
         {RT_MEMBER(TriangleTransform, u), RT_MEMBER(TriangleTransform, v),
          RT_MEMBER(TriangleTransform, plane)}},
        {"TriangleTransformDouble",
         sizeof(TriangleTransformDouble),
         {RT_MEMBER(TriangleTransformDouble, u), RT_MEMBER(TriangleTransformDouble, v),
          RT_MEMBER(TriangleTransformDouble, plane)}},
    };
}

GLint property(const GlProgram& program, GLenum interface, const std::string& name, GLenum wanted) {
    const GLuint index = glGetProgramResourceIndex(program.name(), interface, name.c_str());
    EXPECT_NE(index, GL_INVALID_INDEX) << name;
    GLint value = -1;
    if (index != GL_INVALID_INDEX)
        glGetProgramResourceiv(program.name(), interface, index, 1, &wanted, 1, nullptr, &value);
    return value;
}

// Each struct as the array element of a std430 buffer and as a std140 uniform block.
TEST_F(SharedLayout, ReflectedOffsetsAndSizesAreThoseOfCpp) {
    for (const SharedStruct& shared : sharedStructs()) {
        const GlProgram program = compileComputeProgram(
            compose(fmt::format("{}layout(std430, binding = 0) buffer B {{ {} s[]; }};\nlayout(std140, "
                                "binding = 0) uniform U {{ {} u; }};\n"
                                "void main() {{ s[gl_GlobalInvocationID.x] = u; }}\n",
                                kIncludes, shared.type, shared.type)));
        for (const Member& member : shared.members) {
            SCOPED_TRACE(fmt::format("{}.{}", shared.type, member.name));
            const auto offset = static_cast<GLint>(member.offset);
            EXPECT_EQ(property(program, GL_BUFFER_VARIABLE, fmt::format("s[0].{}", member.name), GL_OFFSET),
                      offset);
            EXPECT_EQ(property(program, GL_UNIFORM, fmt::format("u.{}", member.name), GL_OFFSET), offset);
            EXPECT_EQ(property(program, GL_BUFFER_VARIABLE, fmt::format("s[0].{}", member.name),
                               GL_TOP_LEVEL_ARRAY_STRIDE),
                      static_cast<GLint>(shared.size));
        }
    }
}

TEST_F(SharedLayout, WordsOfNestedVoxelsAreTheSameInGlslAndCpp) {
    constexpr std::size_t kCount = 4096;
    std::mt19937 random(5);
    std::vector<glm::uvec4> words(kCount);
    for (glm::uvec4& word : words) word = glm::uvec4(random(), 0u, 0u, 0u);
    const GlProgram program = compileComputeProgram(compose(
        std::string(kIncludes) +
        "layout(std430, binding = 0) readonly buffer In { uvec4 words[]; };\n"
        "layout(std430, binding = 1) writeonly buffer Out { uvec4 results[]; };\n"
        "void main() {\n    uint i = gl_GlobalInvocationID.x;\n    uint w = words[i].x;\n"
        "    results[3u * i] = uvec4(uvec3(freeBelow(w)), freeBoxWord(freeBelow(w), freeAbove(w)));\n"
        "    results[3u * i + 1u] = uvec4(uvec3(freeAbove(w)), leafWord(leafList(w)));\n"
        "    results[3u * i + 2u] = uvec4(isBrick(w) ? 1u : 0u, brickOffset(w), uint(brickShift(w)),\n"
        "                                 brickWord(brickOffset(w), brickShift(w)));\n}\n"));
    const GlBuffer in = createBuffer(std::as_bytes(std::span(words)));
    const GlBuffer out = createOutputBuffer(3 * kCount * sizeof(glm::uvec4));
    glUseProgram(program.name());
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, in.name());
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, out.name());
    glDispatchCompute(kCount / 64, 1, 1);
    std::vector<glm::uvec4> results(3 * kCount);
    readBuffer(out, std::as_writable_bytes(std::span(results)));
    for (std::size_t i = 0; i < kCount; ++i) {
        const std::uint32_t w = words[i].x;
        ASSERT_EQ(results[3 * i], glm::uvec4(glm::uvec3(freeBelow(w)), w & 0x3FFFFFFFu));
        ASSERT_EQ(freeBoxWord(freeBelow(w), freeAbove(w)), w & 0x3FFFFFFFu);
        ASSERT_EQ(results[3 * i + 1], glm::uvec4(glm::uvec3(freeAbove(w)), leafWord(leafList(w))));
        ASSERT_EQ(results[3 * i + 2], glm::uvec4(isBrick(w), brickOffset(w), brickShift(w), w | kBrickTag));
        ASSERT_EQ(brickWord(brickOffset(w), brickShift(w)), w | kBrickTag);
    }
}

std::vector<glm::vec4> unitVectors() {
    std::vector<glm::vec4> vectors;
    for (int x = -2; x <= 2; ++x)
        for (int y = -2; y <= 2; ++y)
            for (int z = -2; z <= 2; ++z)
                if (x || y || z) vectors.emplace_back(glm::normalize(glm::vec3(x, y, z)), 0.0f);
    std::mt19937 random(3);
    std::normal_distribution<float> normal;
    while (vectors.size() < 65536) {
        const glm::vec3 v(normal(random), normal(random), normal(random));
        vectors.emplace_back(glm::normalize(v), 0.0f);
    }
    return vectors;
}

TEST_F(SharedLayout, OctahedralMapIsTheSameInGlslAndCpp) {
    const std::vector<glm::vec4> vectors = unitVectors();
    const GlProgram program = compileComputeProgram(compose(
        std::string(kIncludes) + "layout(std430, binding = 0) readonly buffer In { vec4 vectors[]; };\n"
                                 "layout(std430, binding = 1) writeonly buffer Bits { uint bits[]; };\n"
                                 "layout(std430, binding = 2) writeonly buffer Out { vec4 decoded[]; };\n"
                                 "void main() {\n    uint i = gl_GlobalInvocationID.x;\n"
                                 "    bits[i] = octEncode(vectors[i].xyz);\n"
                                 "    decoded[i] = vec4(octDecode(octEncode(vectors[i].xyz)), 0.0f);\n}\n"));
    const GlBuffer in = createBuffer(std::as_bytes(std::span(vectors)));
    const GlBuffer bits = createOutputBuffer(vectors.size() * 4);
    const GlBuffer out = createOutputBuffer(vectors.size() * 16);
    glUseProgram(program.name());
    for (const auto& [binding, buffer] : {std::pair(0u, &in), {1u, &bits}, {2u, &out}})
        glBindBufferBase(GL_SHADER_STORAGE_BUFFER, binding, buffer->name());
    glDispatchCompute(static_cast<GLuint>(vectors.size() / 64), 1, 1);
    std::vector<std::uint32_t> gpuBits(vectors.size());
    std::vector<glm::vec4> gpuDecoded(vectors.size());
    readBuffer(bits, std::as_writable_bytes(std::span(gpuBits)));
    readBuffer(out, std::as_writable_bytes(std::span(gpuDecoded)));
    for (std::size_t i = 0; i < vectors.size(); ++i) {
        const std::uint32_t expected = octEncode(glm::vec3(vectors[i]));
        for (const int shift : {0, 16}) // GLSL leaves open how packSnorm2x16 rounds halves
            ASSERT_LE(std::abs(static_cast<std::int16_t>(gpuBits[i] >> shift) -
                               static_cast<std::int16_t>(expected >> shift)),
                      1)
                << "vector " << i;
        const glm::vec3 decoded = octDecode(gpuBits[i]);
        ASSERT_LT(glm::length(decoded - glm::vec3(gpuDecoded[i])), 1e-6f) << "vector " << i;
        ASSERT_LT(glm::length(decoded - glm::vec3(vectors[i])), 1e-4f) << "vector " << i;
    }
}

} // namespace
} // namespace rt

// What goes through the upload ring arrives, in pieces of any size.
#include "tests/gpu/trace_fixture.h"

#include <epoxy/gl.h>

#include <cstring>
#include <random>

namespace rt {
namespace {

std::vector<std::uint32_t> randomWords(std::size_t count) {
    std::mt19937 random(3);
    std::vector<std::uint32_t> words(count);
    for (std::uint32_t& word : words) word = static_cast<std::uint32_t>(random());
    return words;
}

class Upload : public test::OnGpu {};

TEST_F(Upload, BuffersArriveInPiecesOfAnySize) {
    const std::vector<std::uint32_t> words = randomWords(300001);
    const auto bytes = std::as_bytes(std::span(words));
    for (const std::size_t pieceBytes : {std::size_t(1) << 10, std::size_t(999), bytes.size() / 4 + 1,
                                         bytes.size(), UploadRing::kPieceBytes}) {
        UploadRing ring(pieceBytes);
        for (const std::size_t size : {bytes.size(), std::size_t(0), std::size_t(1), pieceBytes,
                                       std::min(bytes.size(), pieceBytes + 1)}) {
            const auto part = bytes.first(std::min(size, bytes.size()));
            const GlBuffer buffer = ring.createBuffer(part);
            std::vector<std::byte> back(part.size());
            readBuffer(buffer, back);
            EXPECT_TRUE(std::equal(back.begin(), back.end(), part.begin()))
                << part.size() << " bytes in pieces of " << pieceBytes;
        }
        ring.finish();
    }
}

TEST_F(Upload, TexturesArriveInRowsInLayersAndWhole) {
    for (const glm::uvec3 size : {glm::uvec3(13, 7, 9), glm::uvec3(16, 1, 40), glm::uvec3(5, 64, 1)}) {
        const std::vector<std::uint32_t> words = randomWords(std::size_t(size.x) * size.y * size.z);
        for (const std::size_t pieceBytes : {64u, 192u, 5u * 64u, 1200u, 4096u, 1u << 20}) {
            UploadRing ring(pieceBytes);
            const GlTexture texture = createTexture3D(GL_TEXTURE_3D, GL_R32UI, size.x, size.y, size.z);
            ring.fillTexture(texture, size, GL_RED_INTEGER, GL_UNSIGNED_INT, words);
            ring.finish();
            std::vector<std::uint32_t> back(words.size());
            glGetTextureImage(texture.name(), 0, GL_RED_INTEGER, GL_UNSIGNED_INT,
                              static_cast<GLsizei>(back.size() * sizeof(back[0])), back.data());
            EXPECT_EQ(back, words) << size.x << "x" << size.y << "x" << size.z << " in pieces of "
                                   << pieceBytes;
        }
    }
}

TEST_F(Upload, SmallPiecesDoNotChangeAHit) {
    const Atlas atlas = test::makeAtlas(test::makeRandomTriangles(300, 8, 0.1f), kStructureNested, {9, 8, 7});
    std::mt19937 random(4);
    std::normal_distribution<float> normal;
    std::vector<QueryRay> rays(3000);
    for (QueryRay& ray : rays)
        ray = {glm::vec4(0.5f, 0.5f, 0.5f, 0.0f),
               glm::vec4(normal(random), normal(random), normal(random), 1e30f)};
    const auto whole = test::traceQuery(*context, atlas, rays);
    test::QuerySettings small;
    small.pieceBytes = 100;
    const auto pieces = test::traceQuery(*context, atlas, rays, small);
    EXPECT_EQ(std::memcmp(whole.data(), pieces.data(), whole.size() * sizeof(QueryHit)), 0);
}

} // namespace
} // namespace rt

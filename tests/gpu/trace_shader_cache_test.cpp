// The cache of compiled shaders: what it keeps, and for how long. tests/cli/trace_test.cpp has what users see
// of it.
#include "tests/gpu/trace_fixture.h"
#include "tests/support/temporary_folder.h"
#include "tools/rt-trace/shader_cache.h"

#include <epoxy/gl.h>

#include <filesystem>

namespace rt {
namespace {

namespace fs = std::filesystem;

class ShaderCaching : public test::OnGpu {
protected:
    void SetUp() override {
        if (!limits().programBinaries) GTEST_SKIP() << "the driver gives no binaries out";
    }
    // Each number makes another source.
    static std::string sourceOf(int number) {
        return "#version 450 core\nlayout(local_size_x = 1) in;\nlayout(std430, binding = 0) buffer B { uint "
               "b; "
               "};\nvoid main() { b = " +
               std::to_string(number) + "u; }\n";
    }
    static bool isFromCache(const ShaderCache& cache, int number) {
        CompilingProgram program({sourceOf(number), {"prelude", "source"}}, &cache);
        const bool fromCache = program.isFromCache();
        const GlProgram finished = program.finish();
        EXPECT_EQ(runs(finished), static_cast<unsigned>(number));
        return fromCache;
    }
    static unsigned runs(const GlProgram& program) {
        const GlBuffer buffer = createDynamicBuffer(4);
        glUseProgram(program.name());
        glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, buffer.name());
        glDispatchCompute(1, 1, 1);
        std::uint32_t value = 0;
        glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
        readBuffer(buffer, std::as_writable_bytes(std::span(&value, 1)));
        return value;
    }
    std::uint64_t bytesInFolder() const {
        std::uint64_t bytes = 0;
        for (const auto& entry : fs::directory_iterator(folder.file(""))) bytes += entry.file_size();
        return bytes;
    }
    test::TemporaryFolder folder;
};

TEST_F(ShaderCaching, EachSourceIsCompiledOnce) {
    const ShaderCache cache(folder.file(""));
    EXPECT_FALSE(isFromCache(cache, 1));
    EXPECT_FALSE(isFromCache(cache, 2));
    EXPECT_TRUE(isFromCache(cache, 1));
    EXPECT_TRUE(isFromCache(ShaderCache(folder.file("")), 2));
}

TEST_F(ShaderCaching, WhatWasUsedLongestAgoGoesFirst) {
    const ShaderCache roomy(folder.file(""));
    isFromCache(roomy, 1);
    const std::uint64_t one = bytesInFolder();
    isFromCache(roomy, 2);
    const auto past = fs::file_time_type::clock::now() - std::chrono::hours(1);
    for (const auto& entry : fs::directory_iterator(folder.file(""))) fs::last_write_time(entry, past);
    EXPECT_TRUE(isFromCache(roomy, 1)); // used now
    const ShaderCache tight(folder.file(""), 2 * one + one / 2);
    EXPECT_FALSE(isFromCache(tight, 3));
    EXPECT_LE(bytesInFolder(), 2 * one + one / 2);
    EXPECT_TRUE(isFromCache(tight, 1));
    EXPECT_TRUE(isFromCache(tight, 3));
    EXPECT_FALSE(isFromCache(tight, 2));
}

TEST_F(ShaderCaching, OtherFilesOfTheFolderStay) {
    writeFile(folder.file("note"), std::string(1000, 'x'));
    const ShaderCache cache(folder.file(""), 1);
    EXPECT_FALSE(isFromCache(cache, 1));
    EXPECT_FALSE(isFromCache(cache, 1)) << "there is no room for any";
    EXPECT_EQ(bytesInFolder(), 1000u);
}

} // namespace
} // namespace rt

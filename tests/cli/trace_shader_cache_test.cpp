// The shaders that rt-trace keeps: when they are taken, and what becomes of damaged ones.
#include "formats/recipe.h"
#include "formats/shader_binary_file.h"
#include "tests/cli/trace_command.h"

#include <sys/stat.h>

namespace rt::test {
namespace {

// Runs of one picture with a cache of shaders of their own.
class ShaderCacheCommand : public TraceCommand {
protected:
    // What the report says of the cache; the picture is to be the same each time.
    bool fromCache(std::vector<std::string> options = {}, const std::string& environment = "UNUSED=1") {
        std::vector<std::string> command = {"/usr/bin/env",
                                            "XDG_CACHE_HOME=" + out.file("cache"),
                                            "RT_NO_SHADER_CACHE=",
                                            environment,
                                            RT_BIN_DIR "/rt-trace",
                                            atlas(),
                                            "-o",
                                            out.file("a.exr"),
                                            "--size",
                                            "16",
                                            "--reproducible",
                                            "--json",
                                            out.file("j")};
        command.insert(command.end(), options.begin(), options.end());
        const CommandResult result = runCommand(command);
        EXPECT_EQ(result.exitCode, 0) << result.err;
        const std::string picture = contentIdOf(out.file("a.exr")).value_or("");
        EXPECT_EQ(picture, first.empty() ? picture : first);
        first = picture;
        return nlohmann::json::parse(readText(out.file("j"))).at("shaderFromCache");
    }
    std::vector<std::string> files() const {
        std::vector<std::string> paths;
        std::error_code absent;
        for (const auto& entry : std::filesystem::directory_iterator(out.file("cache/rt-tools"), absent))
            paths.push_back(entry.path().string());
        return paths;
    }
    std::string first;
};

TEST_F(ShaderCacheCommand, ShadersAreCompiledOnceAndDrawTheSame) {
    EXPECT_FALSE(fromCache({"--no-shader-cache"}));
    EXPECT_FALSE(fromCache({}, "RT_NO_SHADER_CACHE=1"));
    EXPECT_EQ(files().size(), 0u);
    EXPECT_FALSE(fromCache());
    if (files().empty()) GTEST_SKIP() << "the driver gives no binaries out";
    EXPECT_TRUE(fromCache());
    EXPECT_FALSE(fromCache({"--no-shader-cache"}));
    EXPECT_EQ(files().size(), 2u);       // walks and shading
    EXPECT_TRUE(fromCache({"--stats"})); // those that count are kept too
    EXPECT_EQ(files().size(), 4u);
}

TEST_F(ShaderCacheCommand, DamagedAndForeignFilesAreReplaced) {
    EXPECT_FALSE(fromCache());
    if (files().empty()) GTEST_SKIP() << "the driver gives no binaries out";
    const std::string path = files().at(0);
    const std::string whole = readText(path);
    std::string flipped = whole;
    flipped[whole.size() / 2] = static_cast<char>(flipped[whole.size() / 2] ^ 1);
    ShaderBinary foreign = readShaderBinary(path);
    foreign.bytes = std::vector<std::byte>(foreign.bytes.size()); // whole, but no driver's
    writeShaderBinary(out.file("foreign"), foreign);
    ShaderBinary another = readShaderBinary(path);
    another.key ^= 1;
    writeShaderBinary(out.file("another"), another);
    for (const std::string& bytes : {std::string(), whole.substr(0, whole.size() / 2), flipped,
                                     readText(out.file("foreign")), readText(out.file("another"))}) {
        spit(path, bytes);
        EXPECT_FALSE(fromCache());
        EXPECT_EQ(readText(path), whole);
        EXPECT_TRUE(fromCache());
    }
    std::filesystem::remove(path);
    ASSERT_EQ(mkfifo(path.c_str(), 0600), 0) << "reading it would never end";
    EXPECT_FALSE(fromCache());
}

TEST_F(ShaderCacheCommand, WithoutAFolderNothingIsKept) {
    spit(out.file("cache"), "no folder");
    EXPECT_FALSE(fromCache({}, "HOME=" + out.file("cache")));
    EXPECT_FALSE(fromCache({}, "HOME="));
    EXPECT_FALSE(fromCache({}, "HOME=" + out.file("home")));
    const bool kept = fromCache({}, "HOME=" + out.file("home"));
    EXPECT_EQ(kept, std::filesystem::exists(out.file("home/.cache/rt-tools"))) << "the second choice";
}

} // namespace
} // namespace rt::test

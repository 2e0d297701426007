// rt-trace --rays as a user runs it.
#include "formats/recipe.h"
#include "tests/cli/trace_command.h"

#include <cmath>
#include <cstring>

namespace rt::test {
namespace {

using testing::HasSubstr;

// 99 rays from all around, at what is near the middle.
std::string raysFromAllSides() {
    std::string bytes;
    for (int i = 0; i < 99; ++i) {
        const float angle = 0.4f * static_cast<float>(i), height = 0.02f * static_cast<float>(i) - 1.0f;
        const float ray[8] = {3.0f * std::cos(angle), 0.0f,   3.0f * std::sin(angle), 0.0f,
                              -std::cos(angle),       height, -std::sin(angle),       1e30f};
        bytes.append(reinterpret_cast<const char*>(ray), sizeof(ray));
    }
    return bytes;
}

TEST_F(TraceCommand, TheOrderOfRaysDoesNotChangeAHit) {
    spit(out.file("rays"), raysFromAllSides());
    for (const std::string order : {"auto", "coherent", "scattered"})
        ASSERT_EQ(trace({atlas(), "--rays", out.file("rays"), "-o", out.file(order), "--ray-order", order})
                      .exitCode,
                  0);
    const std::string hits = readText(out.file("coherent"));
    EXPECT_EQ(hits.size(), 99u * 16u);
    EXPECT_EQ(readText(out.file("scattered")), hits);
    EXPECT_EQ(readText(out.file("auto")), hits);
}

// Mesa's software renderer ends loops after 65,535 rounds.
TEST_F(TraceCommand, WalksThatTheDeviceCutsShortAreALimitAndNoHits) {
    writeMesh(out.file("s.rtmesh"), makeSphere(7)); // 327,680 triangles in one voxel
    ASSERT_EQ(runCommand({RT_BIN_DIR "/rt-grid", out.file("s.rtmesh"), "-o", out.file("s.rtatlas"),
                          "--structure", "uniform", "--resolution", "1"})
                  .exitCode,
              0);
    spit(out.file("rays"), raysFromAllSides());
    for (const std::string order : {"coherent", "scattered"}) {
        const CommandResult result = trace({out.file("s.rtatlas"), "--rays", out.file("rays"), "-o",
                                            out.file("hits"), "--ray-order", order, "--device", "software"});
        EXPECT_EQ(result.exitCode, 5) << order;
        EXPECT_THAT(result.err, HasSubstr("more steps and triangle tests"));
        EXPECT_FALSE(std::filesystem::exists(out.file("hits")));
    }
    const CommandResult picture =
        trace({out.file("s.rtatlas"), "-o", out.file("p.exr"), "--size", "8x8", "--device", "software"});
    EXPECT_EQ(picture.exitCode, 5);
    EXPECT_FALSE(std::filesystem::exists(out.file("p.exr")));
}

TEST_F(TraceCommand, PrecisionAndTriangleTestAreReportedAndAgree) {
    spit(out.file("rays"), raysFromAllSides());
    const auto hitsOf = [&](const std::string& precision, const std::string& intersect) {
        const std::string file = out.file(precision + intersect);
        EXPECT_EQ(trace({atlas(), "--rays", out.file("rays"), "-o", file, "--precision", precision,
                         "--intersect", intersect, "--json", out.file("j")})
                      .exitCode,
                  0);
        return readText(file);
    };
    const std::string reference = hitsOf("double", "watertight");
    ASSERT_EQ(reference.size(), 99u * 32u);
    for (const std::string intersect : {"watertight", "moller-trumbore", "baldwin-webber"}) {
        const std::string hits = hitsOf("float", intersect);
        ASSERT_EQ(hits.size(), 99u * 16u);
        std::size_t found = 0;
        for (std::size_t i = 0; i < 99; ++i) {
            float t;
            double exact;
            std::memcpy(&t, &hits[16 * i], sizeof t);
            std::memcpy(&exact, &reference[32 * i], sizeof exact);
            EXPECT_NEAR(t, exact, 1e-3) << intersect << ", ray " << i;
            found += t > 0.0f;
        }
        EXPECT_GT(found, 20u);
    }
    const auto features = nlohmann::json::parse(readText(out.file("j"))).at("features");
    EXPECT_TRUE(std::any_of(features.begin(), features.end(), [](const nlohmann::json& feature) {
        return feature.at("macro") == "RT_INTERSECT" && feature.at("value") == 2;
    }));
}

TEST_F(TraceCommand, TracesRaysAndReportsTimes) {
    const float rays[2][8] = {{0, 0, 5, 0, 0, 0, -1, 1e30f}, {0, 0, 5, 0, 0, 0, 1, 1e30f}};
    spit(out.file("rays"), std::string(reinterpret_cast<const char*>(rays), sizeof(rays)));
    ASSERT_EQ(trace({atlas(), "--rays", out.file("rays"), "-o", out.file("hits"), "--repeat", "3", "--stats",
                     "--json", out.file("j")})
                  .exitCode,
              0);
    const std::string hits = readText(out.file("hits"));
    ASSERT_EQ(hits.size(), 32u);
    float t[2];
    std::uint32_t id[2];
    for (std::size_t i = 0; i < 2; ++i) {
        std::memcpy(&t[i], hits.data() + 16 * i, 4);
        std::memcpy(&id[i], hits.data() + 16 * i + 12, 4);
    }
    EXPECT_NEAR(t[0], 4.0f, 0.02f);
    EXPECT_LT(id[0], 1280u);
    EXPECT_EQ(t[1], -1.0f);
    EXPECT_EQ(id[1], 0xFFFFFFFFu);
    const auto json = nlohmann::json::parse(readText(out.file("j")));
    EXPECT_EQ(json.at("rays"), 2);
    EXPECT_EQ(json.at("hits"), 1);
    EXPECT_LE(json.at("minMs").get<double>(), json.at("medianMs").get<double>());
    EXPECT_GT(json.at("mraysPerSecond").get<double>(), 0.0);
    EXPECT_EQ(json.at("structure"), "cloud");
    EXPECT_EQ(json.at("anyHit"), false);
    EXPECT_EQ(json.at("hitsId"), contentIdOf(out.file("hits")).value_or(""));
    EXPECT_EQ(json.at("raysTotal"), 2);
    EXPECT_GT(json.at("firstDispatchMs").get<double>(), json.at("contextMs").get<double>());
}

TEST_F(TraceCommand, HitsThatGoToStandardOutputAreNamedInTheReport) {
    spit(out.file("rays"), raysFromAllSides());
    const CommandResult result =
        trace({atlas(), "--rays", out.file("rays"), "-o", "-", "--json", out.file("j"), "-q"});
    ASSERT_EQ(result.exitCode, 0) << result.err;
    spit(out.file("hits"), result.out);
    EXPECT_EQ(nlohmann::json::parse(readText(out.file("j"))).at("hitsId"),
              contentIdOf(out.file("hits")).value_or(""));
}

TEST_F(TraceCommand, NoRaysGiveAnEmptyFile) {
    spit(out.file("rays"), "");
    ASSERT_EQ(trace({atlas(), "--rays", out.file("rays"), "-o", out.file("hits")}).exitCode, 0);
    EXPECT_TRUE(std::filesystem::exists(out.file("hits")));
    EXPECT_EQ(std::filesystem::file_size(out.file("hits")), 0u);
}

} // namespace
} // namespace rt::test

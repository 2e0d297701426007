#pragma once
#include "tests/gpu/trace_fixture.h"
#include "tools/rt-trace/camera.h"
#include "tools/rt-trace/film.h"
#include "tools/rt-trace/lights.h"
#include "tools/rt-trace/render_loop.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace rt::test {

struct Picture {
    FilmPixels pixels;
    std::vector<glm::uvec4> counters; ///< of each pixel; empty unless work is counted
};

/// To the bit.
template <class T>
bool sameBits(const std::vector<T>& a, const std::vector<T>& b) {
    return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

/// Two programs of one source: a GPU's compiler may contract multiplications and additions in each of them
/// otherwise.
template <class Vector>
void expectNear(const std::vector<Vector>& a, const std::vector<Vector>& b, const char* what) {
    ASSERT_EQ(a.size(), b.size());
    const auto* x = reinterpret_cast<const float*>(a.data());
    const auto* y = reinterpret_cast<const float*>(b.data());
    std::size_t far = 0;
    const std::size_t count = a.size() * sizeof(Vector) / sizeof(float);
    for (std::size_t i = 0; i < count; ++i)
        far += !(std::abs(x[i] - y[i]) <= 1e-4f * std::max(1.0f, std::abs(x[i])));
    EXPECT_LE(double(far), 2e-3 * double(count)) << what; // rays that meet an edge may go either way
}

inline void expectSameOfTwoPrograms(const FilmPixels& a, const FilmPixels& b) {
    expectNear(a.colors, b.colors, "colors");
    expectNear(a.surfaces, b.surfaces, "surfaces");
    expectNear(a.albedos, b.albedos, "albedos");
    expectNear(a.positions, b.positions, "positions");
    expectNear(a.texcoords, b.texcoords, "texcoords");
    ASSERT_EQ(a.ids.size(), b.ids.size());
    std::size_t other = 0;
    for (std::size_t i = 0; i < a.ids.size(); ++i) other += a.ids[i] != b.ids[i];
    EXPECT_LE(double(other), 2e-3 * double(a.ids.size()));
}

inline void expectSame(const FilmPixels& a, const FilmPixels& b) {
    EXPECT_TRUE(sameBits(a.colors, b.colors));
    EXPECT_TRUE(sameBits(a.surfaces, b.surfaces));
    EXPECT_TRUE(sameBits(a.ids, b.ids));
    EXPECT_TRUE(sameBits(a.albedos, b.albedos));
    EXPECT_TRUE(sameBits(a.positions, b.positions));
    EXPECT_TRUE(sameBits(a.texcoords, b.texcoords));
    EXPECT_TRUE(sameBits(a.variances, b.variances));
}

inline BoundsD boundsOfAtlas(const Atlas& atlas) {
    const AtlasInfo& info = atlas.info;
    return {{info.worldLo[0], info.worldLo[1], info.worldLo[2]},
            {info.worldHi[0], info.worldHi[1], info.worldHi[2]}};
}

/// One sample of every pixel into the film, which is bound.
inline FilmPixels renderOneSample(const GpuPrograms& programs, GpuView& view, const Film& film,
                                  const GlContext& context, glm::uvec2 size) {
    TileSamples tiles({0, 0, size}, 1);
    renderTiles(programs, view, film, context, tiles, {});
    return film.read(tiles.window(), tiles.perPixel());
}

/// What rt-trace does for one picture, with its default lights.
struct PictureSettings {
    SceneFeatures features;
    CameraPose pose;
    glm::uvec2 size;
    glm::vec3 background{0.25f, 0.5f, 0.75f};
    float ambient = 0.1f;
};

inline Picture renderPicture(const GlContext& context, const Atlas& atlas, const PictureSettings& settings,
                             const ResourceLimits& resourceLimits) {
    const SceneFeatures& features = settings.features;
    const double aspect = double(settings.size.x) / settings.size.y;
    const auto lights = chooseLights({}, atlas, boundsOfAtlas(atlas), settings.pose);
    const ResourcePlan plan = planResources(atlas, features, ShaderKind::Render, resourceLimits, "atlas");
    const GpuAtlas gpuAtlas =
        uploadAtlas(atlas, plan, context.limits(),
                    static_cast<unsigned>(features.lightCount > 0 ? lights.size() : 0), "atlas");
    RenderParams params = wholePicture(settings.size);
    params.background = glm::vec4(settings.background, 0.0f);
    params.ambient = glm::vec4(glm::vec3(settings.ambient), 0.0f);
    GpuView view(cameraInAtlas(settings.pose, aspect, atlas.grid), params, lights, features,
                 context.limits());
    const Film film({0, 0, settings.size}, features, context.limits());
    const GpuPrograms programs = compileVariant(plan);
    gpuAtlas.bind();
    view.bind();
    film.bind();
    finishCompiling(programs, view);
    const glm::uvec4 whole(0, 0, settings.size);
    return {renderOneSample(programs, view, film, context, settings.size),
            features.countWork ? film.readCounters(whole) : std::vector<glm::uvec4>()};
}

} // namespace rt::test

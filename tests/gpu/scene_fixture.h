#pragma once
#include "common/error.h"
#include "tests/gpu/render_fixture.h"
#include "tools/rt-trace/upload_environment.h"

#include <epoxy/gl.h>
#include <glm/geometric.hpp>

#include <cmath>
#include <utility>

namespace rt::test {

struct Part {
    Mesh mesh;
    Material material;
};

/// The parts' triangles one after the other, each in its material.
inline Mesh joinedParts(const std::vector<Part>& parts) {
    std::vector<glm::vec3> positions, normals;
    std::vector<glm::uvec3> triangles;
    std::vector<std::uint32_t> triangleMaterial;
    std::vector<Material> materials;
    for (const Part& part : parts) {
        const auto first = static_cast<std::uint32_t>(positions.size());
        for (const glm::uvec3& t : part.mesh.triangles) triangles.push_back(t + first);
        triangleMaterial.insert(triangleMaterial.end(), part.mesh.triangles.size(),
                                static_cast<std::uint32_t>(materials.size()));
        positions.insert(positions.end(), part.mesh.positions.begin(), part.mesh.positions.end());
        normals.insert(normals.end(), part.mesh.normals.begin(), part.mesh.normals.end());
        materials.push_back(part.material);
    }
    Mesh mesh;
    mesh.positions = std::move(positions);
    mesh.normals = std::move(normals);
    mesh.triangles = std::move(triangles);
    mesh.triangleMaterial = std::move(triangleMaterial);
    mesh.materials = std::move(materials);
    return mesh;
}

/// The horizontal rectangle, seen from both sides; its normal is +z.
inline Mesh makeFloor(const glm::vec2& lo, const glm::vec2& hi, float z) {
    return makeTriangles({{lo.x, lo.y, z},
                          {hi.x, lo.y, z},
                          {hi.x, hi.y, z},
                          {lo.x, lo.y, z},
                          {hi.x, hi.y, z},
                          {lo.x, hi.y, z}});
}

// Materials that do one thing.
inline Material matt(float albedo) {
    return diffuseMaterial(glm::vec3(albedo));
}
inline Material glowing(const glm::vec3& radiance) {
    Material material = diffuseMaterial(glm::vec3(0.0f));
    material.emission = glm::vec4(radiance, 0.0f);
    return material;
}
inline Material mirror(float reflected) {
    Material material = diffuseMaterial(glm::vec3(0.0f));
    material.reflection.w = reflected;
    return material;
}
inline Material metal(const glm::vec3& color, float roughness) {
    Material material = diffuseMaterial(color);
    material.reflection = glm::vec4(1.0f, roughness, 0.0f, 0.0f);
    return material;
}
inline Material glass(float index, const glm::vec3& color = glm::vec3(1.0f)) {
    Material material = diffuseMaterial(color);
    material.reflection = glm::vec4(0.0f, 0.0f, 1.0f, 0.0f);
    material.transmission.x = 1.0f;
    material.transmission.y = index;
    return material;
}

/// What a scene is seen in; a program is compiled for it.
struct SceneSettings {
    std::vector<Light> lights = {};  ///< world space
    EnvironmentMap environment = {}; ///< none if it has no pixels
    float ambient = 0.0f;
    unsigned maxDepth = 8;
    unsigned view = kPerspectiveView;
    bool lens = false;
    bool multisample = false;
    bool aovs = false;
    std::uint32_t structure = kStructureCloud;
    bool multipass = false;
};

struct Shot {
    CameraPose pose;
    glm::uvec2 size{1};
    unsigned samples = 1;
    float filterRadius = 0.0f; ///< 0: all samples in the middle of the pixel
    unsigned filter = kFilterBox;
    unsigned seed = 0;
    glm::vec3 background{0.0f};
    unsigned samplesPerDispatch = 4; ///< which pictures do not depend on
    float environmentTurn = 0.0f;
};

/// What the shaders make of an environment: mixed between the middles of its four nearest pixels.
inline glm::dvec3 skyOf(const EnvironmentMap& map, const glm::dvec3& direction, double turn = 0.0) {
    constexpr double kPi = 3.14159265358979323846;
    const double u = std::atan2(direction.x, -direction.z) / (2.0 * kPi) + 0.5 + turn;
    const double v = std::acos(std::clamp(direction.y, -1.0, 1.0)) / kPi;
    const double x = (u - std::floor(u)) * map.width - 0.5, y = v * map.height - 0.5;
    glm::dvec3 sum(0.0);
    for (const double right : {0.0, 1.0})
        for (const double below : {0.0, 1.0}) {
            const double column = std::floor(x) + right, row = std::floor(y) + below;
            const auto wrapped =
                (static_cast<int>(column) + static_cast<int>(map.width)) % static_cast<int>(map.width);
            const auto clamped = std::clamp(static_cast<int>(row), 0, static_cast<int>(map.height) - 1);
            sum += glm::dvec3(map.pixels[static_cast<std::size_t>(clamped) * map.width +
                                         static_cast<std::size_t>(wrapped)]) *
                   ((1.0 - std::abs(x - column)) * (1.0 - std::abs(y - row)));
        }
    return sum;
}

/// Mean of the samples, and the standard error of its luminance as the samples themselves tell it.
struct Estimate {
    glm::dvec3 color;
    double error;
};

/// A scene on the device, ready for pictures of it.
class SceneOnGpu {
public:
    SceneOnGpu(const GlContext& context, Mesh mesh, SceneSettings settings = {})
        : context_(context), settings_(std::move(settings)), atlas_(atlasOf(std::move(mesh), settings_)),
          plan_(planResources(atlas_, featuresFor(context, atlas_, settings_), ShaderKind::Render,
                              context.limits().resources, "atlas")),
          gpuAtlas_(uploadAtlas(atlas_, plan_, context.limits(),
                                static_cast<unsigned>(settings_.lights.size()), "atlas")),
          programs_(compileVariant(plan_)) {
        if (!settings_.lights.empty()) lights_ = chooseLights({}, atlas_, boundsOfAtlas(atlas_), {});
        if (plan_.features.hasEnvironment)
            environment_.emplace(settings_.environment, context.limits(), "environment");
    }

    FilmPixels render(const Shot& shot) const {
        const double aspect = double(shot.size.x) / shot.size.y;
        RenderParams params = wholePicture(shot.size);
        params.background = glm::vec4(shot.background, 0.0f);
        params.ambient = glm::vec4(glm::vec3(settings_.ambient), 0.0f);
        params.environment = glm::vec4(glm::vec3(1.0f), shot.environmentTurn);
        params.filterSize.x = shot.filterRadius;
        params.samples = {0, 0, shot.seed, shot.filter};
        GpuView view(cameraInAtlas(shot.pose, aspect, atlas_.grid), params, lights_, plan_.features,
                     context_.limits());
        const Film film({0, 0, shot.size}, plan_.features, context_.limits());
        bind(view, film);
        for (unsigned first = 0; first < shot.samples;) {
            const unsigned count = std::min(shot.samplesPerDispatch, shot.samples - first);
            view.render(programs_, {0, 0, shot.size}, first, count);
            first += count;
        }
        const std::size_t pixels = std::size_t(shot.size.x) * shot.size.y;
        FilmPixels result = film.read({0, 0, shot.size}, std::vector<std::uint32_t>(pixels, shot.samples));
        for (const std::uint32_t id : result.ids)
            if (id == kWalkCutShort) throw Error(ErrorKind::LimitExceeded, "the device ended a loop early");
        return result;
    }

    /// Radiance that reaches `eye` from the direction of `lookAt`, one pixel's worth.
    Estimate estimate(const glm::dvec3& eye, const glm::dvec3& lookAt, unsigned samples = 1,
                      const glm::vec3& background = glm::vec3(0.0f)) const {
        Shot shot;
        shot.pose.eye = eye;
        shot.pose.lookAt = lookAt;
        shot.pose.up = upFor(lookAt - eye);
        shot.pose.fovDegrees = 1.0;
        shot.samples = samples;
        shot.samplesPerDispatch = 64; // these scenes are small
        shot.background = background;
        const FilmPixels pixels = render(shot);
        return {glm::dvec3(glm::vec3(pixels.colors[0])), std::sqrt(double(pixels.variances[0]))};
    }
    glm::dvec3 radiance(const glm::dvec3& eye, const glm::dvec3& lookAt,
                        const glm::vec3& background = glm::vec3(0.0f)) const {
        return estimate(eye, lookAt, 1, background).color;
    }

    /// Any direction that is not along the view.
    static glm::dvec3 upFor(const glm::dvec3& view) {
        return std::abs(view.y) < 0.9 * glm::length(view) ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0);
    }

private:
    static Atlas atlasOf(Mesh mesh, const SceneSettings& settings) {
        mesh.lights = std::vector<Light>(settings.lights);
        validate(mesh, "mesh");
        return makeAtlas(mesh, settings.structure, glm::uvec3(0)); // as fine as its triangles are many
    }
    static SceneFeatures featuresFor(const GlContext& context, const Atlas& atlas,
                                     const SceneSettings& settings) {
        PictureNeeds needs;
        needs.maxDepth = settings.maxDepth;
        needs.lights = settings.lights;
        needs.environment = !settings.environment.pixels.empty();
        needs.view = settings.view;
        needs.lens = settings.lens;
        needs.multisample = settings.multisample;
        needs.aovs = settings.aovs;
        needs.moments = true;
        needs.multipass = settings.multipass;
        SceneFeatures features = renderFeatures(atlas, needs);
        features.software = context.device().software;
        return features;
    }
    void bind(const GpuView& view, const Film& film) const {
        gpuAtlas_.bind();
        view.bind();
        film.bind();
        if (environment_) environment_->bind();
    }

    const GlContext& context_;
    SceneSettings settings_;
    Atlas atlas_;
    ResourcePlan plan_;
    GpuAtlas gpuAtlas_;
    GpuPrograms programs_;
    std::vector<Light> lights_;
    std::optional<GpuEnvironment> environment_;
};

/// The same radiance from all sides.
inline EnvironmentMap evenEnvironment(const glm::vec3& radiance) {
    EnvironmentMap map{2, 1, std::vector<glm::vec3>(2, radiance), {}};
    map.cdf = environmentCdf(map.width, map.height, map.pixels);
    return map;
}

inline testing::AssertionResult isNear(const glm::dvec3& color, const glm::dvec3& expected, double relative) {
    const double most = std::max({expected.x, expected.y, expected.z, 1e-6});
    const double off = glm::distance(color, expected) / most;
    if (off <= relative) return testing::AssertionSuccess();
    return testing::AssertionFailure()
           << color.x << " " << color.y << " " << color.z << ", not " << expected.x << " " << expected.y
           << " " << expected.z << ": off by " << off << " of it";
}

/// Of unpolarized light that meets a smooth border at this angle, the part that is reflected; from index n1
/// to n2. Source: Fresnel 1823, by way of Snell's law.
inline double fresnel(double angle, double n1, double n2) {
    const double sine = std::sin(angle) * n1 / n2;
    if (sine >= 1.0) return 1.0;
    const double inner = std::asin(sine);
    const double s =
        (n1 * std::cos(angle) - n2 * std::cos(inner)) / (n1 * std::cos(angle) + n2 * std::cos(inner));
    const double p =
        (n1 * std::cos(inner) - n2 * std::cos(angle)) / (n1 * std::cos(inner) + n2 * std::cos(angle));
    return 0.5 * (s * s + p * p);
}

} // namespace rt::test

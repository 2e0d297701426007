#pragma once
#include "tests/reference/scene.h"
#include "tools/rt-trace/camera.h"

#include <functional>
#include <vector>

namespace rt::reference {

struct Settings {
    CameraPose pose;
    glm::uvec2 size{1};
    unsigned samples = 1;
    unsigned maxDepth = 8;
    std::vector<Light> lights; ///< world space
    /// Radiance from a direction in which there is no surface.
    std::function<Vec(const Vec& direction)> sky = [](const Vec&) { return Vec(0.0); };
    bool skyLights = false; ///< surfaces too, not only what mirrors it
};

struct Pixel {
    Vec mean{0.0};
    double luminance = 0.0;
    double error = 0.0; ///< standard error of the luminance
};

/// The surface model of formats/material.shared.h by plain random numbers, in double precision: a check on
/// the shaders that shares nothing with them. Each pixel is the mean over its square. Lights with a size and
/// the sky are found by choosing points of them evenly where surfaces are diffuse, and by reflected rays
/// alone where they are glossy.
std::vector<Pixel> render(const Mesh& mesh, const Settings& settings);

} // namespace rt::reference

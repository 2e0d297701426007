#include "tools/rt-trace/option_groups.h"
#include "tools/rt-trace/option_values.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

namespace rt {

void addCameraOptions(CLI::App& app, TraceOptions& options, CameraTexts& texts) {
    CameraRequest& camera = options.camera;
    const std::vector<CLI::Option*> added = {
        app.add_option("--camera", camera.name,
                       "A camera of the scene, see --list-cameras; the options below "
                       "change what they say")
            ->type_name("NAME"),
        app.add_option("--eye", texts.eye, "Where the camera stands; else where it sees the whole scene")
            ->type_name("X,Y,Z"),
        app.add_option("--look-at", texts.lookAt, "What it looks at; else the scene's centre")
            ->type_name("X,Y,Z"),
        app.add_option("--up", texts.up, "Up in the picture; else +y, or +z for a view along y")
            ->type_name("X,Y,Z"),
        app.add_option("--fov", camera.fovDegrees, "Vertical field of view")
            ->type_name("DEG")
            ->default_str(fmt::format("{}", kDefaultFovDegrees)),
        app.add_option(
               "--projection", texts.view,
               "perspective; orthographic: no foreshortening; panorama: all around, 360 by 180 degrees")
            ->check(oneOf({"perspective", "orthographic", "panorama"}))
            ->type_name("perspective|orthographic|panorama"),
        app.add_option("--height", camera.height,
                       "Orthographic: height of what the picture shows; else that of the scene")
            ->type_name("H"),
        app.add_option(
               "--lens-radius", camera.lensRadius,
               "Radius of the lens, in the scene's units: what is out of focus blurs; 0 = all is sharp")
            ->type_name("R"),
        app.add_option("--focus", camera.focusDistance,
                       "Distance from the camera of what is in focus; else that of --look-at")
            ->type_name("DIST"),
        app.add_option("--camera-path", options.cameraPath,
                       "Cameras for --frames: a JSON array of {frame, eye, lookAt, up, fov}, with straight "
                       "lines between its frames; else the path of the scene's --camera")
            ->type_name("FILE"),
        app.add_option(
               "--turntable", options.turntable,
               "With --frames: the camera goes round what it looks at, once in N frames; frame 1 is where it "
               "would stand without")
            ->check(numberBetween(1, 1000000))
            ->type_name("N"),
    };
    for (CLI::Option* option : added) option->group("Pictures: camera");
}

void convertCamera(const CameraTexts& texts, TraceOptions& options) {
    CameraRequest& camera = options.camera;
    if (!texts.eye.empty()) camera.eye = parsePoint(texts.eye, "--eye");
    if (!texts.lookAt.empty()) camera.lookAt = parsePoint(texts.lookAt, "--look-at");
    if (!texts.up.empty()) camera.up = parsePoint(texts.up, "--up");
    for (const unsigned view : {kPerspectiveView, kOrthographicView, kPanoramaView})
        if (texts.view == viewName(view)) camera.view = view;
    if (camera.name.empty()) checkCamera(camera); // else its kind is in the scene
}

} // namespace rt

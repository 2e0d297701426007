#include "common/error.h"
#include "tools/rt-trace/environment.h"
#include "tools/rt-trace/option_groups.h"
#include "tools/rt-trace/option_values.h"
#include "tools/rt-trace/parse_light.h"

#include <CLI/CLI.hpp>

namespace rt {

void addLightOptions(CLI::App& app, TraceOptions& options, LightTexts& texts) {
    const std::vector<CLI::Option*> added = {
        app.add_option(
               "--light", texts.lights,
               "A light instead of the scene's, repeatable: point:X,Y,Z (or X,Y,Z alone), "
               "directional:DX,DY,DZ, spot:X,Y,Z,TX,TY,TZ,OUTER,INNER towards T with half angles in degrees, "
               "rectangle:X,Y,Z,TX,TY,TZ,WIDTH,HEIGHT facing T, sphere:X,Y,Z,RADIUS; each may go on with "
               ",R,G,B; else a white surface at the scene's centre gets a radiance of 0.9")
            ->type_name("[KIND:]X,Y,Z...[,R,G,B]"),
        app.add_option("--ambient", texts.ambient,
                       "Light from everywhere; else 0.1, or none with an environment")
            ->type_name("G|R,G,B"),
        app.add_option("--occlusion", options.occlusion,
                       "Surfaces nearer than this hide ambient light; 0 = none does")
            ->check(notNegative())
            ->type_name("DIST")
            ->capture_default_str(),
        app.add_option("--background", texts.background,
                       "Radiance behind the scene; else the scene's, or 0.32,0.4,0.5")
            ->type_name("G|R,G,B"),
        app.add_option("--environment", options.environment,
                       "Light from far away on all sides, and what is seen there: a picture of 360 by 180 "
                       "degrees, .exr or .hdr, or one colour; else the scene's, if it has one")
            ->type_name("FILE|G|R,G,B"),
        app.add_option("--environment-turn", options.environmentTurn,
                       "Turns it about the scene's +y; else as the scene says of its own, or 0")
            ->type_name("DEG"),
        app.add_option("--environment-strength", options.environmentStrength,
                       "Makes it brighter or darker; else as the scene says of its own, or 1")
            ->check(notNegative())
            ->type_name("X"),
        app.add_option("--max-depth", options.maxDepth, "Reflections and refractions in a row")
            ->check(numberBetween(0, 16))
            ->type_name("N")
            ->capture_default_str(),
    };
    for (CLI::Option* option : added) option->group("Pictures: light");
}

void convertLight(const LightTexts& texts, TraceOptions& options) {
    if (!texts.ambient.empty()) options.ambient = parseColor(texts.ambient, "--ambient");
    if (!texts.background.empty()) options.background = parseColor(texts.background, "--background");
    if (!options.environment.empty()) checkEnvironment(options.environment);
    for (const std::string& light : texts.lights) options.lights.push_back(parseLight(light));
}

} // namespace rt

#include "common/error.h"
#include "formats/image.h"
#include "tools/rt-trace/option_groups.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>

namespace rt {
namespace {

bool writes(const TraceOptions& options, ImageFileType type) {
    return std::any_of(options.outputPaths.begin(), options.outputPaths.end(),
                       [=](const std::string& path) { return imageFileType(path) == type; });
}

// Whoever says --spp 1 knows: scripts say it to be quick.
bool hasSamples(const CLI::App& app, const TraceOptions& options) {
    return options.samples > 1 || app.get_option("--spp")->count() > 0;
}
bool showsBackground(const CLI::App&, const TraceOptions& options) {
    return options.environment.empty();
}
bool hasAmbient(const CLI::App&, const TraceOptions& options) {
    return options.ambient.value_or(glm::vec3(options.environment.empty() ? 1.0f : 0.0f)) !=
               glm::vec3(0.0f) ||
           options.occlusion == 0.0;
}
bool isMapped(const CLI::App&, const TraceOptions& options) {
    return writes(options, ImageFileType::Png) && options.heat == Heat::None;
}
bool isToneMapped(const CLI::App& app, const TraceOptions& options) {
    return isMapped(app, options) || options.toneMap == ToneMap::None;
}
bool isExposed(const CLI::App& app, const TraceOptions& options) {
    return isMapped(app, options) || options.exposureStops == 0.0;
}
bool showsHeat(const CLI::App&, const TraceOptions& options) {
    return options.heat != Heat::None;
}
bool hasChannels(const CLI::App&, const TraceOptions& options) {
    return options.outputPaths.empty() || writes(options, ImageFileType::Exr);
}
bool isShard(const CLI::App&, const TraceOptions& options) {
    return options.shard.has_value();
}

// Those that depend on the scene are elsewhere: checkCamera(), setUpPicture().
struct EffectRule {
    const char* option;
    bool (*hasEffect)(const CLI::App&, const TraceOptions&);
    const char* needs;
};
constexpr EffectRule kRules[] = {
    {"--filter", hasSamples, "more samples than one; add --spp N"},
    {"--filter-radius", hasSamples, "more samples than one; add --spp N"},
    {"--background", showsBackground,
     "a picture without --environment, which is what is seen behind the scene"},
    {"--occlusion", hasAmbient, "light from everywhere; add --ambient"},
    {"--tonemap", isToneMapped, "a .png among the outputs that does not show --heat"},
    {"--exposure", isExposed, "a .png among the outputs that does not show --heat"},
    {"--heat-max", showsHeat, "--heat"},
    {"--shard-by", isShard, "--shard"},
    {"--aov", hasChannels, "an .exr among the outputs"},
};

} // namespace

void requireEffect(const CLI::App& app, const TraceOptions& options) {
    for (const EffectRule& rule : kRules)
        if (app.get_option(rule.option)->count() > 0 && !rule.hasEffect(app, options))
            throw Error(ErrorKind::Usage, fmt::format("{} needs {}", rule.option, rule.needs));
}

} // namespace rt

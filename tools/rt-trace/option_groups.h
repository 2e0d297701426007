#pragma once
#include "tools/rt-trace/options.h"

namespace CLI {
class App;
}

// The options of pictures, group by group as --help shows them. What add...Options() cannot parse at once it
// keeps as text; convert...() reads that when all options are known, and throws Error{Usage}.

namespace rt {

/// Groups of --help whose options are for pictures begin like this.
inline constexpr const char* kPictureGroup = "Pictures";

struct CameraTexts {
    std::string view;
    std::string eye, lookAt, up;
};
void addCameraOptions(CLI::App& app, TraceOptions& options, CameraTexts& texts);
void convertCamera(const CameraTexts& texts, TraceOptions& options);

struct LightTexts {
    std::vector<std::string> lights;
    std::string ambient;
    std::string background;
};
void addLightOptions(CLI::App& app, TraceOptions& options, LightTexts& texts);
void convertLight(const LightTexts& texts, TraceOptions& options);

struct SampleTexts {
    std::string filter = "box";
    std::optional<double> filterRadius;
    std::optional<unsigned> samples;
};
void addSampleOptions(CLI::App& app, TraceOptions& options, SampleTexts& texts);
void convertSamples(const SampleTexts& texts, TraceOptions& options);

struct OutputTexts {
    std::string size = "512x512";
    std::string crop;
    std::string aovs = "Z,N,id";
    std::string toneMap = "none";
    std::string heat;
    std::string frames;
};
void addOutputOptions(CLI::App& app, TraceOptions& options, OutputTexts& texts);
/// After convertSamples(), which says whether there is a variance.
void convertOutput(const OutputTexts& texts, TraceOptions& options);

struct ShardTexts {
    std::string shard;
    std::string kind = "parts";
};
void addShardOptions(CLI::App& app, ShardTexts& texts);
/// After all the others: they decide what there is to share.
void convertShard(const ShardTexts& texts, TraceOptions& options);

/// Throws Error{Usage} naming the first option that was given and changes nothing because of the others.
void requireEffect(const CLI::App& app, const TraceOptions& options);

} // namespace rt

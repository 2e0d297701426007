#pragma once
#include "tools/rt-trace/option_groups.h"

namespace rt {

/// Options whose text is parsed once all of them are known.
struct PictureTexts {
    CameraTexts camera;
    LightTexts light;
    SampleTexts samples;
    OutputTexts output;
    std::string kernel = "compute";
    ShardTexts shard;
};

void addPictureOptions(CLI::App& app, TraceOptions& options, PictureTexts& texts);

/// Throws Error{Usage}.
void convertPictureTexts(const CLI::App& app, const PictureTexts& texts, TraceOptions& options);

} // namespace rt

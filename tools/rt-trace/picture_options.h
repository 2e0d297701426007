#pragma once
#include "tools/rt-trace/options.h"

namespace CLI {
class App;
}

namespace rt {

/// Groups of --help whose options are for pictures begin like this.
inline constexpr const char* kPictureGroup = "Pictures";

/// Options whose text is parsed once all of them are known.
struct PictureTexts {
    std::string size = "512x512";
    std::string crop;
    std::string ambient;
    std::string background;
    std::string view;
    std::string eye, lookAt, up;
    std::vector<std::string> lights;
    std::string filter = "box";
    std::optional<double> filterRadius;
    std::optional<unsigned> samples;
    std::string aovs = "Z,N,id";
    std::string toneMap = "none";
    std::string heat;
    std::string frames;
};

void addPictureOptions(CLI::App& app, TraceOptions& options, PictureTexts& texts);

/// Throws Error{Usage}.
void convertPictureTexts(const PictureTexts& texts, TraceOptions& options);

/// The path with its %d or %04d replaced by the frame's number; nothing unless there is exactly one.
std::optional<std::string> framePath(const std::string& path, unsigned frame);

} // namespace rt

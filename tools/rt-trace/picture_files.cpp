#include "tools/rt-trace/picture_files.h"

#include "common/binary_io.h"
#include "formats/heat_color.h"
#include "formats/image.h"

#include <algorithm>
#include <cmath>

namespace rt {
namespace {

std::vector<float>* valuesOf(Image& image, const char* name) {
    for (ImageChannel& channel : image.channels)
        if (channel.name == name) return &channel.values;
    return nullptr;
}

// Of the pixels: some are interrupted while the clock goes on.
constexpr double kTimedPart = 0.99;

// What this part of the pixels does not exceed.
double figureAtPart(const std::vector<glm::vec4>& figures, int component, double part) {
    std::vector<float> values;
    for (const glm::vec4& ofPixel : figures) values.push_back(ofPixel[component]);
    if (values.empty()) return 0.0;
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(part * double(values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

} // namespace

double paintHeat(FilmPixels& pixels, Heat heat, double most) {
    const std::vector<glm::vec4>& figures = heat == Heat::Time ? pixels.albedos : pixels.texcoords;
    const int component = heat == Heat::Steps ? 2 : 3;
    if (most <= 0.0) most = figureAtPart(figures, component, heat == Heat::Time ? kTimedPart : 1.0);
    for (std::size_t i = 0; i < pixels.colors.size(); ++i) {
        const double figure = figures[i][component];
        const glm::dvec3 color = heatColor(most > 0.0 ? figure / most : 0.0);
        for (int c = 0; c < 3; ++c) pixels.colors[i][c] = static_cast<float>(decodeSrgb(color[c]));
    }
    return most;
}

Image forScreen(Image image, ToneMap map, double exposureStops) {
    // Its viewers would hide the background where nothing was hit.
    std::erase_if(image.channels, [](const ImageChannel& channel) { return channel.name == "A"; });
    std::vector<float>* const r = valuesOf(image, "R");
    std::vector<float>* const g = valuesOf(image, "G");
    std::vector<float>* const b = valuesOf(image, "B");
    if (!r || !g || !b || (map == ToneMap::None && exposureStops == 0.0)) return image;
    const double factor = std::exp2(exposureStops);
    for (std::size_t i = 0; i < r->size(); ++i) {
        const glm::dvec3 shown = toneMapped(map, factor * glm::dvec3((*r)[i], (*g)[i], (*b)[i]));
        (*r)[i] = static_cast<float>(shown.r);
        (*g)[i] = static_cast<float>(shown.g);
        (*b)[i] = static_cast<float>(shown.b);
    }
    return image;
}

void writePictures(const std::vector<std::string>& paths, const Image& image, ToneMap map,
                   double exposureStops, const Recipe& recipe) {
    std::vector<std::vector<std::byte>> files;
    for (const std::string& path : paths) {
        const bool screen = imageFileType(path) == ImageFileType::Png;
        files.push_back(
            sealed(encodeImage(path, screen ? forScreen(image, map, exposureStops) : image), recipe));
    }
    for (std::size_t i = 0; i < paths.size(); ++i) writeFile(paths[i], files[i]);
}

} // namespace rt

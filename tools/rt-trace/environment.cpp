#include "tools/rt-trace/environment.h"

#include "common/binary_io.h"
#include "common/error.h"
#include "common/log.h"
#include "formats/image_exr.h"
#include "formats/image_hdr.h"
#include "tools/rt-trace/option_values.h"
#include "tools/rt-trace/tone_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rt {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr unsigned kColorRows = 64; // so that directions are chosen evenly over the sphere
constexpr const char* kOption = "--environment";

std::string extensionOf(const std::string& path) {
    const std::size_t dot = path.find_last_of("./");
    std::string extension = dot == std::string::npos ? "" : path.substr(dot);
    for (char& c : extension)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return extension;
}

const std::vector<float>& channelOf(const Image& image, const char* name, const std::string& path) {
    const ImageChannel* channel = image.find(name);
    if (!channel) channel = image.find("Y");
    if (!channel || channel->type == ImageChannel::Type::Uint)
        throw Error(ErrorKind::InvalidContent,
                    fmt::format("{}: lacks the channel {}; an environment has R, G, B or Y", path, name));
    return channel->values;
}

// What is no light becomes none.
void cleanPixels(std::vector<glm::vec3>& pixels, const std::string& path) {
    std::size_t cleaned = 0;
    for (glm::vec3& pixel : pixels)
        for (int c = 0; c < 3; ++c) {
            if (std::isfinite(pixel[c]) && pixel[c] >= 0.0f) continue;
            pixel[c] = 0.0f;
            ++cleaned;
        }
    if (cleaned > 0)
        logWarning(fmt::format("{}: {} values are negative or not finite and count as 0", path, cleaned));
}

EnvironmentMap readEnvironment(const std::string& path) {
    const Image image = extensionOf(path) == ".exr" ? readExr(path) : decodeHdr(readFile(path), path);
    const std::vector<float>& r = channelOf(image, "R", path);
    const std::vector<float>& g = channelOf(image, "G", path);
    const std::vector<float>& b = channelOf(image, "B", path);
    EnvironmentMap map{image.width, image.height, {}, {}};
    map.pixels.reserve(image.pixelCount());
    for (std::size_t i = 0; i < image.pixelCount(); ++i) map.pixels.emplace_back(r[i], g[i], b[i]);
    cleanPixels(map.pixels, path);
    return map;
}

// Appends the borders' parts of the whole; returns the sum.
double appendCdf(const std::vector<double>& values, std::vector<float>& cdf) {
    double sum = 0.0;
    for (const double value : values) sum += value;
    double below = 0.0;
    const auto count = static_cast<double>(values.size());
    cdf.push_back(0.0f);
    for (std::size_t i = 0; i + 1 < values.size(); ++i) {
        below += values[i];
        cdf.push_back(static_cast<float>(sum > 0.0 ? below / sum : static_cast<double>(i + 1) / count));
    }
    cdf.push_back(1.0f);
    return sum;
}

} // namespace

bool isEnvironmentFile(const std::string& text) {
    const std::string extension = extensionOf(text);
    return extension == ".exr" || extension == ".hdr";
}

void checkEnvironment(const std::string& text) {
    if (isEnvironmentFile(text)) return;
    if (text.find_first_not_of("0123456789.,+-eE") != std::string::npos)
        throw Error(
            ErrorKind::Usage,
            fmt::format("{}: '{}' is neither a colour nor a file that ends in .exr or .hdr", kOption, text));
    parseColor(text, kOption);
}

EnvironmentMap loadEnvironment(const std::string& text) {
    checkEnvironment(text);
    EnvironmentMap map;
    if (isEnvironmentFile(text))
        map = readEnvironment(text);
    else
        map = {2, kColorRows, std::vector<glm::vec3>(2 * kColorRows, parseColor(text, kOption)), {}};
    map.cdf = environmentCdf(map.width, map.height, map.pixels);
    return map;
}

std::vector<float> environmentCdf(unsigned width, unsigned height, const std::vector<glm::vec3>& pixels) {
    std::vector<float> rows;
    std::vector<double> rowSums;
    std::vector<double> values(width);
    for (unsigned row = 0; row < height; ++row) {
        const double sine = std::sin(kPi * (row + 0.5) / height);
        for (unsigned x = 0; x < width; ++x)
            values[x] = luminanceOf(glm::dvec3(pixels[std::size_t(row) * width + x])) * sine;
        rowSums.push_back(appendCdf(values, rows));
    }
    std::vector<float> cdf = {static_cast<float>(width), static_cast<float>(height), 0.0f};
    const double sum = appendCdf(rowSums, cdf);
    cdf[2] = static_cast<float>(sum / (double(width) * double(height)));
    cdf.insert(cdf.end(), rows.begin(), rows.end());
    return cdf;
}

} // namespace rt

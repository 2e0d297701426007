#include "tools/rt-trace/environment.h"

#include "common/error.h"
#include "common/log.h"
#include "tools/rt-trace/option_values.h"
#include "tools/rt-trace/tone_map.h"

#include <fmt/format.h>

#include <cmath>

namespace rt {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr const char* kOption = "--environment";

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
    return mapOf(isEnvironmentFile(text) ? readEnvironment(text)
                                         : evenEnvironment(parseColor(text, kOption)));
}

EnvironmentMap mapOf(EnvironmentPicture picture) {
    std::vector<float> cdf = environmentCdf(picture.width, picture.height, picture.pixels);
    return {picture.width, picture.height, std::move(picture.pixels), std::move(cdf)};
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

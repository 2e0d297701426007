#include "tools/rt-grid/slice_legend.h"

#include "formats/heat_color.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

// Text as rectangles, in a header without a .cpp file of its own that warns of signs and unused functions.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb/stb_easy_font.h>
#pragma GCC diagnostic pop

namespace rt {
namespace {

const glm::dvec3 kWhite(1.0);
const glm::dvec3 kBlack(0.0);

} // namespace

LegendScale::LegendScale(double least, double most, bool isLogarithmic)
    : least_(least), most_(most), isLogarithmic_(isLogarithmic) {}

double LegendScale::part(double value) const {
    if (!(most_ > least_)) return 0.5;
    return isLogarithmic_ ? std::log(value / least_) / std::log(most_ / least_)
                          : (value - least_) / (most_ - least_);
}

std::vector<double> LegendScale::ticks() const {
    std::vector<double> values;
    if (isLogarithmic_) {
        for (double value = std::exp2(std::ceil(std::log2(least_))); value <= most_; value *= 2.0)
            values.push_back(value);
    } else {
        for (double value = std::ceil(least_); value <= most_; value += 1.0) values.push_back(value);
    }
    if (values.empty()) values.push_back(least_);
    constexpr std::size_t kMost = 10;
    const std::size_t stride = (values.size() + kMost - 1) / kMost;
    std::vector<double> kept;
    for (std::size_t i = 0; i < values.size(); i += stride) kept.push_back(values[i]);
    if (part(most_) - part(kept.back()) > 0.06) kept.push_back(most_);
    return kept;
}

LegendCanvas::LegendCanvas(int width, int height, const std::string& title, const LegendScale& scale)
    : width_(width + 3 * kMargin + kBarWidth + kNumbersWidth),
      height_(std::max(height, kBarHeight) + top_ + kMargin),
      colors_(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_), kWhite) {
    write(kMargin, kMargin, title);
    fill(kMargin - 1, top_ - 1, width + 2, height + 2, kBlack);
    fill(kMargin, top_, width, height, kWhite);
    drawBar(width + 2 * kMargin, scale);
}

void LegendCanvas::drawBar(int x, const LegendScale& scale) {
    fill(x - 1, top_ - 1, kBarWidth + 2, kBarHeight + 2, kBlack);
    const bool isOneValue = scale.ticks().size() == 1;
    for (int y = 0; y < kBarHeight; ++y)
        fill(x, top_ + y, kBarWidth, 1, heatColor(isOneValue ? 0.5 : 1.0 - (y + 0.5) / kBarHeight));
    for (const double tick : scale.ticks()) {
        const int y = top_ + static_cast<int>(std::lround((1.0 - scale.part(tick)) * (kBarHeight - 1)));
        fill(x + kBarWidth, y, 6, 1, kBlack);
        write(x + kBarWidth + 14, y - kLineHeight / 2 + kTextScale, fmt::format("{:.4g}", tick));
    }
}

void LegendCanvas::put(int x, int y, const glm::dvec3& color) {
    if (x < 0 || x >= width_ || y < 0 || y >= height_) return;
    colors_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x)] =
        color;
}

void LegendCanvas::fill(int x, int y, int width, int height, const glm::dvec3& color) {
    for (int j = y; j < y + height; ++j)
        for (int i = x; i < x + width; ++i) put(i, j, color);
}

void LegendCanvas::write(int x, int y, const std::string& text) {
    struct Vertex {
        float x, y, z;
        unsigned char color[4];
    };
    std::string copy = text; // the header takes no constants
    std::vector<Vertex> vertices(text.size() * 80);
    const int quads = stb_easy_font_print(0.0f, 0.0f, copy.data(), nullptr, vertices.data(),
                                          static_cast<int>(vertices.size() * sizeof(Vertex)));
    for (int quad = 0; quad < quads; ++quad) {
        const Vertex& lo = vertices[static_cast<std::size_t>(4 * quad)];
        const Vertex& hi = vertices[static_cast<std::size_t>(4 * quad + 2)];
        fill(x + kTextScale * static_cast<int>(lo.x), y + kTextScale * static_cast<int>(lo.y),
             kTextScale * static_cast<int>(hi.x - lo.x), kTextScale * static_cast<int>(hi.y - lo.y), kBlack);
    }
}

Image LegendCanvas::image() const {
    Image image;
    image.width = static_cast<std::uint32_t>(width_);
    image.height = static_cast<std::uint32_t>(height_);
    for (const int channel : {2, 1, 0}) {
        ImageChannel values{std::string(1, "RGB"[channel]), ImageChannel::Type::Float, {}, {}};
        for (const glm::dvec3& color : colors_)
            values.values.push_back(static_cast<float>(decodeSrgb(color[channel])));
        image.channels.push_back(std::move(values));
    }
    return image;
}

} // namespace rt

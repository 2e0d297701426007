#pragma once
#include "formats/image.h"

#include <glm/vec3.hpp>
#include <string>
#include <vector>

namespace rt {

/// From values to parts of a colour bar.
class LegendScale {
public:
    /// Values from `least` to `most`, both above 0 where `isLogarithmic`.
    LegendScale(double least, double most, bool isLogarithmic);
    /// 0 for the least, 1 for the most.
    double part(double value) const;
    /// Values to write beside the bar, at most about ten: whole ones, or powers of two.
    std::vector<double> ticks() const;

private:
    double least_, most_;
    bool isLogarithmic_;
};

/// A white picture with a title above it and a colour bar with numbers at its right.
class LegendCanvas {
public:
    LegendCanvas(int width, int height, const std::string& title, const LegendScale& scale);
    /// Of the picture without title and bar; the colour is sRGB-encoded.
    void setPixel(int x, int y, const glm::dvec3& color) { put(x + kMargin, y + top_, color); }
    Image image() const;

private:
    static constexpr int kMargin = 16;
    static constexpr int kTextScale = 2;
    static constexpr int kLineHeight = 9 * kTextScale;
    static constexpr int kBarWidth = 24;
    static constexpr int kBarHeight = 320;
    static constexpr int kNumbersWidth = 96;

    void put(int x, int y, const glm::dvec3& color);
    void fill(int x, int y, int width, int height, const glm::dvec3& color);
    void write(int x, int y, const std::string& text);
    void drawBar(int x, const LegendScale& scale);

    int top_ = kMargin + kLineHeight + kMargin / 2; // of the picture inside the canvas
    int width_, height_;
    std::vector<glm::dvec3> colors_;
};

} // namespace rt

#include "tools/rt-compare/html_report.h"

#include "formats/heat_color.h"
#include "tools/rt-compare/heat_map.h"
#include "tools/rt-compare/markup.h"
#include "tools/rt-compare/report_page.h"

#include <glm/gtc/packing.hpp>
#include <nlohmann/json.hpp>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <new>

namespace rt {
namespace {

using Json = nlohmann::json;
using Bytes = std::vector<std::uint8_t>;

// How a picture of a part is made smaller for the page.
struct PageScale {
    std::uint32_t width, height; // of the whole picture
    std::uint32_t step = 1;      // pixels each way that become one

    explicit PageScale(const PixelBox& box) : width(box.width()), height(box.height()) {
        while (std::uint64_t(pageWidth()) * pageHeight() > kMaxPagePixels) ++step;
    }
    std::uint32_t pageWidth() const { return (width + step - 1) / step; }
    std::uint32_t pageHeight() const { return (height + step - 1) / step; }

    // combine(sum so far, value) over each block, finish(sum, count): one value of the page.
    template <class Value, class Combine, class Finish>
    std::vector<Value> shrunk(const std::vector<float>& values, Combine&& combine, Finish&& finish) const {
        std::vector<Value> result;
        result.reserve(std::size_t(pageWidth()) * pageHeight());
        for (std::uint32_t y0 = 0; y0 < height; y0 += step)
            for (std::uint32_t x0 = 0; x0 < width; x0 += step) {
                const std::uint32_t endX = std::min(x0 + step, width), endY = std::min(y0 + step, height);
                double sum = 0.0;
                for (std::uint32_t y = y0; y < endY; ++y)
                    for (std::uint32_t x = x0; x < endX; ++x)
                        sum = combine(sum, double(values[std::size_t(y) * width + x]));
                result.push_back(finish(sum, double(endX - x0) * double(endY - y0)));
            }
        return result;
    }
};

std::string base64(const Bytes& bytes) {
    static constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
        std::uint32_t word = 0;
        for (std::size_t k = 0; k < 3; ++k) word = word << 8 | (k < count ? bytes[i + k] : 0u);
        for (std::size_t k = 0; k < 4; ++k) text += k <= count ? kDigits[word >> (18 - 6 * k) & 63] : '=';
    }
    return text;
}

std::string packed(const Bytes& bytes) {
    uLongf size = compressBound(bytes.size());
    Bytes result(size);
    if (compress2(result.data(), &size, bytes.data(), bytes.size(), 6) != Z_OK)
        throw std::bad_alloc(); // the only way in which it fails
    result.resize(size);
    return base64(result);
}

std::uint16_t halfOf(double value) {
    if (std::isnan(value)) return 0x7e00;
    if (std::isinf(value)) return value > 0.0 ? 0x7c00 : 0xfc00;
    return glm::packHalf1x16(static_cast<float>(std::clamp(value, -65504.0, 65504.0)));
}

// As report_page.js reads them: along rows the differences, high bytes before low ones.
std::string packedHalves(const PageScale& scale, const std::vector<float>& values) {
    const auto halves = scale.shrunk<std::uint16_t>(
        values, [](double sum, double value) { return sum + value; },
        [](double sum, double count) { return halfOf(sum / count); });
    Bytes bytes(2 * halves.size());
    for (std::size_t i = 0; i < halves.size(); ++i) {
        const unsigned before = i % scale.pageWidth() == 0 ? 0u : halves[i - 1];
        const unsigned difference = (halves[i] - before) & 0xffffu;
        bytes[i] = static_cast<std::uint8_t>(difference >> 8);
        bytes[halves.size() + i] = static_cast<std::uint8_t>(difference & 0xffu);
    }
    return packed(bytes);
}

// Values from 0 to 1 as bytes; only 0 becomes 0.
std::string packedBytes(const PageScale& scale, const std::vector<float>& values) {
    const auto levels = scale.shrunk<std::uint8_t>(
        values, [](double most, double value) { return std::max(most, value); },
        [](double most, double) {
            return static_cast<std::uint8_t>(most > 0.0 ? std::max(std::lround(255.0 * most), 1l) : 0l);
        });
    Bytes bytes(levels.size());
    for (std::size_t i = 0; i < levels.size(); ++i)
        bytes[i] = static_cast<std::uint8_t>(levels[i] - (i % scale.pageWidth() == 0 ? 0 : levels[i - 1]));
    return packed(bytes);
}

Json flipHistogram(const std::vector<float>& flip, const ComparedRegion& region) {
    std::array<std::uint64_t, 64> counts{};
    for (std::size_t i = 0; i < flip.size(); ++i)
        if (region.isCompared(i))
            ++counts[std::min(static_cast<std::size_t>(flip[i] * 64.0f), std::size_t(63))];
    return counts;
}

Json describeLayer(const PageScale& scale, const PreparedPair& pair, const PerceptionMaps& maps,
                   std::size_t index) {
    const LayerPair& layer = pair.layers[index];
    Json result{{"name", layer.name}};
    for (const char* name : {"R", "G", "B", "Y"}) {
        const ChannelPair* const channel = layer.kind == LayerKind::Color ? layer.find(name) : nullptr;
        if (!channel) continue;
        result["a"].push_back(packedHalves(scale, channel->a->values));
        result["b"].push_back(packedHalves(scale, channel->b->values));
    }
    result["heat"] = packedBytes(scale, heatValues(pair, maps, index, HeatFigure::Abs));
    if (maps.flip.empty()) return result;
    result["flip"] = packedBytes(scale, maps.flip);
    result["flipHistogram"] = flipHistogram(maps.flip, pair.regions[layer.part]);
    return result;
}

Json heatColors() {
    Json colors = Json::array();
    for (int i = 0; i < 256; ++i) {
        const glm::dvec3 color = heatColor(i / 255.0) * 255.0;
        colors.push_back({std::lround(color.r), std::lround(color.g), std::lround(color.b)});
    }
    return colors;
}

Json pageData(const Json& report, const PreparedPair& pair, const std::vector<PerceptionMaps>& maps) {
    Json data{{"report", report},
              {"scale", pair.a.scale == ValueScale::Linear ? "linear" : "display"},
              {"heatColors", heatColors()},
              {"layers", Json::array()}};
    if (pair.layers.empty()) return data;
    const PixelBox& box = pair.regions.front().box;
    const PageScale scale(box);
    data.update({{"x0", box.x0},
                 {"y0", box.y0},
                 {"width", scale.pageWidth()},
                 {"height", scale.pageHeight()},
                 {"step", scale.step}});
    for (std::size_t i = 0; i < pair.layers.size(); ++i)
        if (pair.layers[i].part == 0) data["layers"].push_back(describeLayer(scale, pair, maps[i], i));
    return data;
}

// JSON as it may stand inside a <script>.
std::string escapedJson(const Json& data) {
    std::string text = data.dump(-1, ' ', false, Json::error_handler_t::replace), result;
    result.reserve(text.size());
    for (const char c : text)
        if (c == '<')
            result += "\\u003c";
        else
            result += c;
    return result;
}

// `page` with each {{name}} replaced, in one pass: what replaces one is not looked into.
std::string filled(const std::string& page, const std::vector<std::pair<std::string, std::string>>& texts) {
    std::string result;
    std::size_t at = 0;
    for (const auto& [name, text] : texts) {
        const std::string mark = "{{" + name + "}}";
        const std::size_t found = page.find(mark, at);
        result += page.substr(at, found - at) + text;
        at = found + mark.size();
    }
    return result + page.substr(at);
}

} // namespace

std::string htmlReport(const Json& report, const PairResult& result) {
    const std::string title = "rt-compare: " + report.at("verdict").get<std::string>() + ": " +
                              report.at("a").at("file").get<std::string>();
    return filled(kReportPage, {{"title", escapedMarkup(title)},
                                {"style", kReportStyle},
                                {"data", escapedJson(pageData(report, *result.pair, result.maps))},
                                {"script", kReportScript}});
}

} // namespace rt

#include "tests/bench/pixel_blocks.h"

#include "common/error.h"

#include <fmt/format.h>

#include <array>

namespace rt::bench {
namespace {

constexpr std::array kColors = {"A", "B", "G", "R"}; // sorted, as an image's channels are

std::vector<float> averaged(const std::vector<float>& values, std::uint32_t width, std::uint32_t side) {
    const std::size_t outWidth = width / side, outHeight = values.size() / width / side;
    std::vector<double> sums(outWidth * outHeight, 0.0);
    for (std::size_t i = 0; i < values.size(); ++i)
        sums[i / width / side * outWidth + i % width / side] += values[i];
    std::vector<float> means;
    means.reserve(sums.size());
    for (const double sum : sums) means.push_back(static_cast<float>(sum / (double(side) * side)));
    return means;
}

} // namespace

Image averageBlocks(const Image& image, std::uint32_t side, const std::string& name) {
    if (image.width % side != 0 || image.height % side != 0)
        throw Error(ErrorKind::InvalidContent, fmt::format("{}: {} x {} pixels are no blocks of {} x {}",
                                                           name, image.width, image.height, side, side));
    Image result;
    result.width = image.width / side;
    result.height = image.height / side;
    for (const char* color : kColors)
        if (const ImageChannel* channel = image.find(color); channel && !channel->values.empty())
            result.channels.push_back(
                {color, ImageChannel::Type::Float, averaged(channel->values, image.width, side), {}});
    if (result.channels.empty())
        throw Error(ErrorKind::InvalidContent, name + ": none of the channels R, G, B and A to average");
    return result;
}

} // namespace rt::bench

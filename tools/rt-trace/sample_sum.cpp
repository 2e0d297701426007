#include "tools/rt-trace/sample_sum.h"

#include "tools/rt-trace/render_image.h"
#include "tools/rt-trace/tone_map.h"

#include <stdexcept>

namespace rt {
namespace {

ChannelRule ruleOf(const ImageChannel& channel) {
    const std::optional<ChannelRule> rule = channelRule(channel.name);
    if (!rule) throw std::logic_error("channel " + channel.name + " has no rule");
    return *rule;
}

} // namespace

void SampleSum::addMeans(const ImageChannel& channel, unsigned samples, std::vector<double>& sums) {
    sums.resize(channel.values.size());
    for (std::size_t i = 0; i < sums.size(); ++i) sums[i] += double(channel.values[i]) * samples;
}

void SampleSum::addVariances(const Image& image, unsigned samples, std::vector<double>& sums) {
    const std::vector<float>& variances = image.find("variance")->values;
    const std::vector<float>& r = colorChannel(image, "R", "shard").values;
    const std::vector<float>& g = colorChannel(image, "G", "shard").values;
    const std::vector<float>& b = colorChannel(image, "B", "shard").values;
    sums.resize(variances.size());
    luminances_.resize(variances.size());
    const double before = samples_, n = samples, all = before + n;
    for (std::size_t i = 0; i < sums.size(); ++i) {
        const double apart = luminanceOf({r[i], g[i], b[i]}) - luminances_[i];
        sums[i] += double(variances[i]) * n * (n - 1.0);
        if (before > 0.0) sums[i] += apart * apart * before * n / all;
        luminances_[i] += apart * n / all;
    }
}

void SampleSum::add(const Image& image, unsigned samples) {
    if (samples_ == 0.0) image_ = image;
    sums_.resize(image.channels.size());
    for (std::size_t i = 0; i < image.channels.size(); ++i) {
        const ChannelRule rule = ruleOf(image.channels[i]);
        if (rule == ChannelRule::Mean) addMeans(image.channels[i], samples, sums_[i]);
        if (rule == ChannelRule::Variance) addVariances(image, samples, sums_[i]);
    }
    samples_ += samples;
}

Image SampleSum::result() const {
    Image image = image_;
    for (std::size_t i = 0; i < image.channels.size(); ++i) {
        const bool isVariance = ruleOf(image.channels[i]) == ChannelRule::Variance;
        const double divisor = isVariance ? samples_ * (samples_ - 1.0) : samples_;
        std::vector<float>& values = image.channels[i].values;
        for (std::size_t p = 0; p < sums_[i].size(); ++p)
            values[p] = static_cast<float>(sums_[i][p] / divisor);
    }
    return image;
}

} // namespace rt

#include "tools/rt-trace/merge_shards.h"

#include "common/error.h"
#include "common/log.h"
#include "formats/image_attributes.h"
#include "formats/image_exr.h"
#include "tools/rt-trace/render_image.h"
#include "tools/rt-trace/sample_sum.h"
#include "tools/rt-trace/shard.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <span>

namespace rt {
namespace {

constexpr std::uint32_t kRows = 64; // at a time: a multiple of what ZIP compresses together

// Takes away what the shards do not all say alike.
template <class Map>
void keepCommon(const std::vector<ShardFile>& files, Map Image::*attributes, Map& common) {
    std::erase_if(common, [&](const auto& attribute) {
        return std::any_of(files.begin(), files.end(), [&](const ShardFile& file) {
            const auto found = (file.header.*attributes).find(attribute.first);
            return found == (file.header.*attributes).end() || found->second != attribute.second;
        });
    });
}

SampleRange rangeOf(const ShardFile& file) {
    const ShardRecord& record = file.record;
    return samplesOf({record.index, record.count, record.kind}, record.samples);
}

void mergeSamples(const std::vector<ShardFile>& files, Image& header) {
    const bool bySamples = files[0].record.kind == ShardKind::Samples;
    std::int32_t samples = 0;
    for (const ShardFile& file : files) {
        const auto found = file.header.ints.find(kSamplesKey);
        const auto most = static_cast<std::int32_t>(rangeOf(file).count);
        if (found == file.header.ints.end() || found->second < (bySamples ? most : 1) || found->second > most)
            throw Error(ErrorKind::InvalidContent,
                        fmt::format("{}: is damaged: its attribute {} is missing or not what this shard has",
                                    file.path, kSamplesKey));
        samples = bySamples ? samples + found->second : std::max(samples, found->second);
    }
    header.ints[kSamplesKey] = samples;
}

void mergeTimes(const std::vector<ShardFile>& files, Image& header) {
    double seconds = 0.0;
    for (const ShardFile& file : files) {
        const auto found = file.header.floats.find(kRenderSecondsKey);
        if (found == file.header.floats.end()) return; // of one that is reproducible: nobody knows the sum
        seconds += double(found->second);
    }
    header.floats[kRenderSecondsKey] = static_cast<float>(seconds);
}

void mergeRenderers(const std::vector<ShardFile>& files, Image& header) {
    std::set<std::string> renderers;
    for (const ShardFile& file : files)
        if (const auto found = file.header.texts.find(kRendererKey); found != file.header.texts.end())
            renderers.insert(found->second);
    if (renderers.empty()) return;
    header.texts[kRendererKey] = fmt::format("{}", fmt::join(renderers, ", "));
    if (renderers.size() > 1)
        logWarning(fmt::format("the shards were rendered on devices of several kinds, which may round "
                               "differently: {}",
                               header.texts[kRendererKey]));
}

/// One shard, whose rows are read from its top to its bottom.
class ShardRows {
public:
    explicit ShardRows(const ShardFile& file) : file_(&file), hash_(file.record) {}

    Image next(std::uint32_t count) {
        Image rows = decodeExrRows(file_->bytes, file_->path, {done_, count});
        done_ += count;
        hash_.add(rows);
        if (done_ == file_->header.height && hash_.value() != file_->record.pixelHash)
            throw Error(ErrorKind::InvalidContent,
                        file_->path + ": is damaged, or was changed after it was rendered: its pixels do not "
                                      "have the hash that its header says; render this shard again");
        return rows;
    }
    unsigned samples() const { return rangeOf(*file_).count; }

private:
    const ShardFile* file_;
    PixelHash hash_;
    std::uint32_t done_ = 0;
};

// Shards of the same pixels; one alone is taken as it is.
Image nextRows(std::span<ShardRows> shards, std::uint32_t count) {
    if (shards.size() == 1) return shards[0].next(count);
    SampleSum sum;
    for (ShardRows& shard : shards) sum.add(shard.next(count), shard.samples());
    return sum.result();
}

} // namespace

Recipe wholeRecipeOf(const std::vector<ShardFile>& files) {
    std::set<std::string> texts;
    for (const ShardFile& file : files) {
        const auto found = file.header.texts.find(kWholeRecipeKey);
        texts.insert(found == file.header.texts.end() ? "" : found->second);
    }
    return texts.size() == 1 ? Recipe(*texts.begin()) : Recipe();
}

Image mergedHeader(const std::vector<ShardFile>& files) {
    Image header = files[0].header;
    const auto& [x0, y0, x1, y1] = files[0].record.window;
    header.width = x1 - x0;
    header.height = y1 - y0;
    header.frame->x = static_cast<std::int32_t>(x0);
    header.frame->y = static_cast<std::int32_t>(y0);
    if (header.width == header.frame->width && header.height == header.frame->height) header.frame.reset();
    keepCommon(files, &Image::texts, header.texts);
    keepCommon(files, &Image::ints, header.ints);
    keepCommon(files, &Image::floats, header.floats);
    header.texts.erase(kRecipeKey); // a shard's own
    header.texts.erase(kWholeRecipeKey);
    mergeSamples(files, header);
    mergeTimes(files, header);
    mergeRenderers(files, header);
    for (const ImageChannel& channel : header.channels)
        if (!channelRule(channel.name))
            throw Error(ErrorKind::InvalidContent,
                        fmt::format("{}: has the channel {}, which rt-trace does not make", files[0].path,
                                    channel.name));
    return header;
}

void mergeRows(const std::vector<ShardFile>& files, const std::function<void(const Image& rows)>& take) {
    const bool bySamples = files[0].record.kind == ShardKind::Samples;
    const std::size_t together = bySamples ? files.size() : 1;
    for (std::size_t begin = 0; begin < files.size(); begin += together) {
        std::vector<ShardRows> shards;
        for (std::size_t i = begin; i < begin + together; ++i) shards.emplace_back(files[i]);
        const std::uint32_t height = files[begin].header.height;
        for (std::uint32_t done = 0; done < height; done += kRows)
            take(nextRows(shards, std::min(kRows, height - done)));
    }
}

} // namespace rt

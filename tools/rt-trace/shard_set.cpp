#include "tools/rt-trace/shard_set.h"

#include "common/error.h"
#include "formats/exr_header.h"
#include "formats/image_attributes.h"
#include "formats/image_exr.h"
#include "formats/recipe.h"
#include "tools/rt-trace/shard.h"

#include <fmt/format.h>

#include <algorithm>

namespace rt {
namespace {

[[noreturn]] void throwInvalid(const std::string& message) {
    throw Error(ErrorKind::InvalidContent, message);
}

glm::uvec4 wholeWindow(const ShardRecord& record) {
    const auto& [x0, y0, x1, y1] = record.window;
    return {x0, y0, x1, y1};
}

// That the pixels are those that this shard has.
void checkWindow(const ShardFile& file) {
    const ShardRecord& record = file.record;
    const glm::uvec4 whole = wholeWindow(record);
    const ImageFrame frame = file.header.frame.value();
    const bool fits = whole.z <= frame.width && whole.w <= frame.height &&
                      record.count <= mostShards(record.kind, whole, record.samples);
    const glm::uvec4 own = fits ? windowOf({record.index, record.count, record.kind}, whole) : glm::uvec4(0);
    if (!fits || frame.x != static_cast<int>(own.x) || frame.y != static_cast<int>(own.y) ||
        file.header.width != own.z - own.x || file.header.height != own.w - own.y)
        throwInvalid(fmt::format(
            "{}: is damaged: its {}x{} pixels at {},{} are not those of shard {}/{}; render "
            "this shard again",
            file.path, file.header.width, file.header.height, frame.x, frame.y, record.index, record.count));
}

ShardFile openShard(const std::string& path) {
    const std::string name = inputName(path);
    const auto refuseOthers = [&](std::span<const std::byte> head) -> std::optional<std::uint64_t> {
        requireExrMagic(head, name);
        return std::nullopt;
    };
    ShardFile file{name, readFile(path, {kExrStartBytes, refuseOthers, {}}), {}, {}};
    file.header = decodeExrHeader(file.bytes, name);
    const std::optional<ShardRecord> record = takeShardRecord(file.header, name);
    if (!record)
        throwInvalid(name +
                     ": is no shard of a picture: it lacks the attribute rt:shard; render it with --shard");
    file.record = *record;
    checkWindow(file);
    if (isSealBroken(file.bytes))
        throwInvalid(name +
                     ": is damaged, or was changed after it was rendered: its bytes do not have the hash in "
                     "its attribute rt:recipe; render this shard again");
    return file;
}

std::string channelsOf(const Image& image) {
    std::string text;
    for (const ImageChannel& channel : image.channels)
        text += fmt::format("{}:{} ", channel.name, static_cast<int>(channel.type));
    return text;
}

std::string textIn(const Image& image, const char* key) {
    const auto found = image.texts.find(key);
    return found == image.texts.end() ? "" : found->second;
}

std::string seedOf(const Image& image) {
    const auto found = image.ints.find(kSeedKey);
    return found == image.ints.end() ? "none" : fmt::format("{}", found->second);
}

// What decides a picture, each with a name and a text that is the same if that is.
using Identity = std::vector<std::pair<std::string, std::string>>;
Identity identityOf(const ShardFile& file) {
    const Image& image = file.header;
    const ShardRecord& record = file.record;
    std::string matrices;
    for (const auto& [name, values] : image.matrices)
        matrices += fmt::format("{} {}\n", name, fmt::join(values, " "));
    Identity identity = {
        {"atlas", textIn(image, kAtlasHashKey) + textIn(image, kSceneHashKey)},
        {"--size", fmt::format("{}x{}", image.frame->width, image.frame->height)},
        {"--crop", fmt::format("{}", fmt::join(record.window, ","))},
        {"--seed", seedOf(image)},
        {"--spp", fmt::format("{}", record.samples)},
        {"--aov", channelsOf(image)},
        {"number of shards", fmt::format("{}", record.count)},
        {"--shard-by", fmt::format("{}", static_cast<int>(record.kind))},
        {"version of rt-trace", textIn(image, kSoftwareKey)},
        {"matrices of the camera", matrices},
    };
    for (const ShardRecord::Setting& setting : record.settings)
        identity.emplace_back(setting.name, fmt::format("{:016x}", setting.hash));
    return identity;
}

// The names of what differs.
std::string differenceOf(const Identity& of, const Identity& than) {
    std::string names;
    for (std::size_t i = 0; i < std::max(of.size(), than.size()); ++i)
        if (i >= of.size() || i >= than.size() || of[i] != than[i])
            names += fmt::format("{}{}", names.empty() ? "" : ", ", (i < of.size() ? of : than)[i].first);
    return names;
}

// The picture is the one that most of the files are of; of several the first one's.
void requireOnePicture(const std::vector<ShardFile>& files) {
    std::vector<Identity> pictures;
    std::map<Identity, std::size_t> counts;
    for (const ShardFile& file : files) ++counts[pictures.emplace_back(identityOf(file))];
    std::size_t most = 0;
    for (std::size_t i = 1; i < files.size(); ++i)
        if (counts[pictures[i]] > counts[pictures[most]]) most = i;
    for (std::size_t i = 0; i < files.size(); ++i)
        if (pictures[i] != pictures[most])
            throwInvalid(fmt::format("{}: is a shard of another picture than {}: these differ: {}",
                                     files[i].path, files[most].path,
                                     differenceOf(pictures[i], pictures[most])));
}

// "2, 5-7": the numbers from 1 to `count` that are not among the files', which are in their order.
std::string missingFrom(const std::vector<ShardFile>& files, unsigned count) {
    std::string text;
    unsigned next = 1;
    const auto addGap = [&](unsigned end) {
        if (next >= end) return;
        text += fmt::format("{}{}", text.empty() ? "" : ", ", next);
        if (next + 1 < end) text += fmt::format("-{}", end - 1);
    };
    for (const ShardFile& file : files) {
        addGap(file.record.index);
        next = file.record.index + 1;
    }
    addGap(count + 1);
    return text;
}

} // namespace

std::vector<ShardFile> openShards(const std::vector<std::string>& paths) {
    std::vector<ShardFile> files;
    for (const std::string& path : paths) files.push_back(openShard(path));
    requireOnePicture(files);
    std::stable_sort(files.begin(), files.end(),
                     [](const ShardFile& a, const ShardFile& b) { return a.record.index < b.record.index; });
    for (std::size_t i = 1; i < files.size(); ++i)
        if (files[i].record.index == files[i - 1].record.index)
            throwInvalid(fmt::format("{}: is shard {}/{}, as is {}; name each shard once", files[i].path,
                                     files[i].record.index, files[i].record.count, files[i - 1].path));
    const unsigned count = files[0].record.count;
    const std::string missing = missingFrom(files, count);
    if (!missing.empty())
        throwInvalid(fmt::format("{}: of the {} shards of its picture these are missing: {}", files[0].path,
                                 count, missing));
    return files;
}

} // namespace rt

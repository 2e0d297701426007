#include "formats/shard_record.h"

#include "common/error.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <charconv>
#include <new>
#include <span>
#include <string_view>

namespace rt {
namespace {

constexpr const char* kIndex = "rt:shard";
constexpr const char* kKind = "rt:shardBy";
constexpr const char* kWindow = "rt:shardWindow";
constexpr const char* kSamples = "rt:shardSamples";
constexpr const char* kSettings = "rt:shardSettings";
constexpr const char* kHash = "rt:shardHash";

std::map<std::string, std::string> textsOf(const ShardRecord& record) {
    std::string settings;
    for (const ShardRecord::Setting& setting : record.settings)
        settings += fmt::format("{}{}={:016x}", settings.empty() ? "" : ";", setting.name, setting.hash);
    return {{kIndex, fmt::format("{}/{}", record.index, record.count)},
            {kKind, kShardKindNames[static_cast<std::size_t>(record.kind)]},
            {kWindow, fmt::format("{}", fmt::join(record.window, ","))},
            {kSamples, fmt::format("{}", record.samples)},
            {kSettings, settings}};
}

/// Reads a text from its front to its end; after a fault nothing more is read.
class TextReader {
public:
    explicit TextReader(std::string_view text) : rest_(text) {}

    template <class Number>
    Number number(int base = 10) {
        Number value = 0;
        const auto [end, status] = std::from_chars(rest_.data(), rest_.data() + rest_.size(), value, base);
        good_ = good_ && status == std::errc();
        if (good_) rest_.remove_prefix(static_cast<std::size_t>(end - rest_.data()));
        return value;
    }
    void expect(char c) {
        good_ = good_ && rest_.starts_with(c);
        if (good_) rest_.remove_prefix(1);
    }
    /// Up to the character, which is skipped.
    std::string until(char c) {
        const std::size_t end = rest_.find(c);
        good_ = good_ && end != std::string_view::npos;
        if (!good_) return {};
        const std::string text(rest_.substr(0, end));
        rest_.remove_prefix(end + 1);
        return text;
    }
    std::string_view rest() const { return rest_; }
    bool good() const { return good_; }
    bool finished() const { return good_ && rest_.empty(); }

private:
    std::string_view rest_;
    bool good_ = true;
};

bool readIndex(TextReader text, ShardRecord& record) {
    record.index = text.number<unsigned>();
    text.expect('/');
    record.count = text.number<unsigned>();
    return text.finished() && record.index >= 1 && record.index <= record.count;
}

bool readKind(TextReader text, ShardRecord& record) {
    record.kind = text.rest() == kShardKindNames[1] ? ShardKind::Samples : ShardKind::Parts;
    return text.rest() == kShardKindNames[static_cast<std::size_t>(record.kind)];
}

bool readWindow(TextReader text, ShardRecord& record) {
    for (std::size_t i = 0; i < record.window.size(); ++i) {
        if (i > 0) text.expect(',');
        record.window[i] = text.number<std::uint32_t>();
    }
    const auto& [x0, y0, x1, y1] = record.window;
    constexpr std::uint32_t kMost = 1u << 30;
    return text.finished() && x0 < x1 && y0 < y1 && x1 <= kMost && y1 <= kMost;
}

bool readSamples(TextReader text, ShardRecord& record) {
    record.samples = text.number<std::uint32_t>();
    return text.finished() && record.samples >= 1;
}

bool readSettings(TextReader text, ShardRecord& record) {
    while (text.good() && !text.rest().empty()) {
        if (!record.settings.empty()) text.expect(';');
        ShardRecord::Setting& setting = record.settings.emplace_back();
        setting.name = text.until('=');
        setting.hash = text.number<std::uint64_t>(16);
    }
    return text.finished();
}

bool readHash(TextReader text, ShardRecord& record) {
    record.pixelHash = text.number<std::uint64_t>(16);
    return text.finished();
}

struct AttributeReader {
    const char* key;
    bool (*read)(TextReader, ShardRecord&); // false if the text is damaged
};
constexpr AttributeReader kReaders[] = {{kIndex, readIndex},       {kKind, readKind},
                                        {kWindow, readWindow},     {kSamples, readSamples},
                                        {kSettings, readSettings}, {kHash, readHash}};

} // namespace

struct PixelHash::State {
    XXH3_state_t* const hash = XXH3_createState();
    ~State() { XXH3_freeState(hash); }
};

PixelHash::PixelHash(const ShardRecord& record) : state_(std::make_unique<State>()) {
    if (!state_->hash) throw std::bad_alloc();
    XXH3_64bits_reset(state_->hash);
    for (const auto& [key, text] : textsOf(record)) {
        const std::string line = fmt::format("{}={}\n", key, text);
        XXH3_64bits_update(state_->hash, line.data(), line.size());
    }
}
PixelHash::PixelHash(PixelHash&&) noexcept = default;
PixelHash::~PixelHash() = default;

void PixelHash::add(const Image& rows) {
    const auto addRow = [&]<class T>(const std::vector<T>& values, std::size_t row) {
        XXH3_64bits_update(state_->hash, values.data() + row * rows.width, rows.width * sizeof(T));
    };
    for (std::size_t row = 0; row < rows.height; ++row)
        for (const ImageChannel& channel : rows.channels)
            if (channel.type == ImageChannel::Type::Uint)
                addRow(channel.uints, row);
            else
                addRow(channel.values, row);
}

std::uint64_t PixelHash::value() const {
    return XXH3_64bits_digest(state_->hash);
}

void addShardRecord(Image& image, const ShardRecord& record) {
    image.texts.merge(textsOf(record));
    image.texts[kHash] = fmt::format("{:016x}", record.pixelHash);
}

std::optional<ShardRecord> takeShardRecord(Image& image, const std::string& name) {
    if (!image.texts.contains(kIndex)) return std::nullopt;
    ShardRecord record;
    for (const auto& [key, read] : kReaders) {
        const auto found = image.texts.find(key);
        const std::string text = found == image.texts.end() ? "" : found->second;
        if (found == image.texts.end() || !read(TextReader(text), record))
            throw Error(ErrorKind::InvalidContent,
                        fmt::format("{}: is damaged: its attribute {} is '{}'; render this shard again", name,
                                    key, text));
        image.texts.erase(found);
    }
    return record;
}

} // namespace rt

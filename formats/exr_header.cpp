#include "formats/exr_header.h"

#include "common/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <string_view>

namespace rt {
namespace {

[[noreturn]] void throwInvalid(const std::string& name, const std::string& what) {
    throw Error(ErrorKind::InvalidContent, name + ": " + what);
}

class HeaderWalk {
public:
    HeaderWalk(std::span<const std::byte> file, const std::string& name, bool severalParts)
        : file_(file), name_(name) {
        readVersion(severalParts);
        do {
            readPart();
        } while (result_.multiPart && textSize("header") != 0);
        at_ += result_.multiPart ? 1 : 0; // the empty header that ends the list
        result_.bytes.assign(file_.begin(), file_.begin() + static_cast<std::ptrdiff_t>(at_));
        for (std::size_t position : opaqueTypes_) result_.bytes[position] = std::byte{'~'};
    }
    SafeExrHeader take() { return std::move(result_); }

private:
    void readPart() {
        constexpr std::size_t kMaxParts = 1024;
        if (++result_.parts > kMaxParts)
            throw Error(ErrorKind::LimitExceeded,
                        fmt::format("{}: has more than {} parts", name_, kMaxParts));
        while (const std::size_t nameSize = textSize("attribute name")) {
            at_ += nameSize + 1;
            readAttribute();
        }
        at_ += 1;
    }

    void readVersion(bool severalParts) {
        requireExrMagic(file_, name_);
        constexpr std::uint32_t kVersion = 2;
        constexpr std::uint32_t kTiled = 0x200, kLongNames = 0x400, kDeep = 0x800, kMultiPart = 0x1000;
        const std::uint32_t version = number(4);
        if ((version & 0xffu) != kVersion)
            throwInvalid(name_,
                         fmt::format("has OpenEXR version {}; only version 2 is read", version & 0xffu));
        result_.multiPart = (version & kMultiPart) != 0;
        if (result_.multiPart && !severalParts)
            throwInvalid(name_, "has several parts; extract one with exrmultipart -separate");
        if (version & kDeep) throwInvalid(name_, "holds deep pixels; flatten it first");
        if (version & ~(0xffu | kTiled | kLongNames | kMultiPart))
            throwInvalid(name_, fmt::format("has unknown OpenEXR flags {:#x}", version));
    }

    std::uint32_t number(std::size_t position) const {
        std::uint32_t value = 0;
        std::memcpy(&value, file_.data() + position, sizeof value);
        return value;
    }

    // Length of the zero-terminated text at at_.
    std::size_t textSize(const char* what) const {
        constexpr std::size_t kMaxText = 255;
        const auto rest = file_.subspan(at_).first(std::min(kMaxText + 1, file_.size() - at_));
        const auto end = std::find(rest.begin(), rest.end(), std::byte{0});
        if (end == rest.end())
            throwInvalid(
                name_, fmt::format("header is damaged or truncated: {} at byte {} does not end", what, at_));
        return static_cast<std::size_t>(end - rest.begin());
    }

    void readAttribute() {
        const std::size_t typeAt = at_;
        const std::size_t typeSize = textSize("attribute type");
        const std::string_view type(reinterpret_cast<const char*>(file_.data() + at_), typeSize);
        at_ += typeSize + 1;
        if (file_.size() - at_ < 4) throwInvalid(name_, "header is truncated");
        const std::uint32_t size = number(at_);
        at_ += 4;
        if (size > file_.size() - at_)
            throwInvalid(
                name_,
                fmt::format("header is damaged or truncated: an attribute of type '{}' claims {} bytes, "
                            "{} are left",
                            type, size, file_.size() - at_));
        checkValue(type, size);
        if (!isParsed(type)) opaqueTypes_.push_back(typeAt);
        at_ += size;
    }

    struct KnownType {
        std::string_view name;
        std::uint32_t size; // 0 = any
    };
    static constexpr std::array<KnownType, 13> kParsed{{{"box2i", 16},
                                                        {"chlist", 0},
                                                        {"chromaticities", 32},
                                                        {"compression", 1},
                                                        {"envmap", 1},
                                                        {"float", 4},
                                                        {"int", 4},
                                                        {"lineOrder", 1},
                                                        {"m44d", 128},
                                                        {"m44f", 64},
                                                        {"string", 0},
                                                        {"tiledesc", 9},
                                                        {"v2f", 8}}};

    static bool isParsed(std::string_view type) {
        return std::ranges::any_of(kParsed, [&](const KnownType& known) { return known.name == type; });
    }

    void checkValue(std::string_view type, std::uint32_t size) const {
        for (const KnownType& known : kParsed)
            if (known.name == type && known.size != 0 && known.size != size)
                throwInvalid(name_, fmt::format("header is damaged: '{}' has {} bytes, {} wanted", type, size,
                                                known.size));
        if (type == "chlist") checkChannelList(size);
    }

    void checkChannelList(std::uint32_t size) const {
        constexpr std::size_t kChannelBytes = 16; // type, flags, x and y sampling after the name
        std::size_t left = size, position = at_;
        std::string_view before; // the channel before
        for (;;) {
            const auto* text = reinterpret_cast<const char*>(file_.data() + position);
            const std::size_t nameSize = strnlen(text, left);
            if (nameSize == left) break;
            if (nameSize == 0 && left == 1) return;
            if (nameSize == 0 || left - nameSize - 1 < kChannelBytes) break;
            const std::string_view channel(text, nameSize);
            requireOrder(before, channel);
            before = channel;
            position += nameSize + 1 + kChannelBytes;
            left -= nameSize + 1 + kChannelBytes;
        }
        throwInvalid(name_, "header is damaged: the list of channels does not end where it should");
    }

    // The pixels stand in the order of the list, which readers sort: in another one they would be mixed up.
    void requireOrder(std::string_view before, std::string_view channel) const {
        if (before == channel)
            throwInvalid(name_, fmt::format("header is damaged: there are two channels {}", channel));
        if (before > channel)
            throwInvalid(name_, fmt::format("header is damaged: channel {} stands before {}; their order "
                                            "must be alphabetical",
                                            before, channel));
    }

    std::span<const std::byte> file_;
    const std::string& name_;
    std::size_t at_ = 8;
    std::vector<std::size_t> opaqueTypes_;
    SafeExrHeader result_;
};

} // namespace

void requireExrMagic(std::span<const std::byte> bytes, const std::string& name) {
    constexpr std::uint32_t kMagic = 20000630;
    std::uint32_t magic = 0;
    if (bytes.size() >= kExrStartBytes) std::memcpy(&magic, bytes.data(), sizeof magic);
    if (magic != kMagic) throwInvalid(name, "is not an OpenEXR file");
}

SafeExrHeader safeExrHeader(std::span<const std::byte> file, const std::string& name, bool severalParts) {
    return HeaderWalk(file, name, severalParts).take();
}

} // namespace rt

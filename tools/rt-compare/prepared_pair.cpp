#include "tools/rt-compare/prepared_pair.h"

#include "common/error.h"
#include "tools/rt-compare/layers.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rt {
namespace {

std::string describe(const PixelBox& box) {
    return fmt::format("{},{},{},{}", box.x0, box.y0, box.x1, box.y1);
}

PixelBox intersection(const PixelBox& one, const PixelBox& other) {
    return {std::max(one.x0, other.x0), std::max(one.y0, other.y0), std::min(one.x1, other.x1),
            std::min(one.y1, other.y1)};
}

PixelBox unionOf(const PixelBox& one, const PixelBox& other) {
    return {std::min(one.x0, other.x0), std::min(one.y0, other.y0), std::max(one.x1, other.x1),
            std::max(one.y1, other.y1)};
}

template <class T>
void moveValues(std::vector<T>& values, const PixelBox& from, const PixelBox& to) {
    if (values.empty()) return;
    std::vector<T> moved(to.pixelCount()); // 0 where `from` has nothing
    const PixelBox both = intersection(from, to);
    for (std::int32_t y = both.y0; y < both.y1; ++y) {
        const auto source = values.begin() + std::ptrdiff_t(y - from.y0) * from.width() + (both.x0 - from.x0);
        std::copy_n(source, both.width(),
                    moved.begin() + std::ptrdiff_t(y - to.y0) * to.width() + (both.x0 - to.x0));
    }
    values = std::move(moved);
}

void clearIgnored(PicturePart& part, const Focus& focus) {
    for (ImageChannel& channel : part.image.channels)
        for (std::size_t i = 0; i < focus.ignored.size(); ++i)
            if (focus.ignored[i])
                (channel.values.empty() ? void(channel.uints[i] = 0) : void(channel.values[i] = 0));
}

// Names every difference between two parts beside their values.
class PartComparer {
public:
    PartComparer(const PicturePart& a, const PicturePart& b, std::string prefix,
                 const std::set<std::string>& allowed, std::vector<Finding>& findings)
        : a_(a), b_(b), prefix_(std::move(prefix)), allowed_(allowed), findings_(findings) {}

    /// Returns whether their pixels can be compared.
    bool run() {
        const bool comparable = compareWindows();
        if (a_.pixelAspect != b_.pixelAspect)
            add("pixel-aspect",
                fmt::format("pixel aspects differ: {:g} against {:g}", a_.pixelAspect, b_.pixelAspect));
        compareChromaticities();
        for (const char* name : {"worldToCamera", "worldToNDC"}) compareMatrix(name);
        for (const char* name : {"screenWindowWidth", "screenWindowCenter", "view", "envmap"})
            compareCamera(name);
        for (const std::string& text : describeChannelDifferences(a_.image, b_.image, prefix_))
            findings_.push_back({"channels", text, !allowed_.contains("channels")});
        return comparable;
    }

private:
    void add(const char* kind, const std::string& text) {
        const std::string where =
            prefix_.empty() ? "" : "part " + prefix_.substr(0, prefix_.size() - 1) + ": ";
        findings_.push_back({kind, where + text, !allowed_.contains(kind)});
    }

    bool compareWindows() {
        const PixelBox &sizeA = a_.displayWindow, &sizeB = b_.displayWindow;
        if (sizeA.width() != sizeB.width() || sizeA.height() != sizeB.height())
            add("size", fmt::format("sizes differ: {} x {} against {} x {}", sizeA.width(), sizeA.height(),
                                    sizeB.width(), sizeB.height()));
        else if (sizeA != sizeB)
            add("size",
                fmt::format("display windows differ: {} against {}", describe(sizeA), describe(sizeB)));
        if (a_.dataWindow == b_.dataWindow) return true;
        const bool areWhole = a_.dataWindow == sizeA && b_.dataWindow == sizeB; // said by "size" already
        if (!areWhole)
            add("data-window", fmt::format("data windows differ: {} against {}", describe(a_.dataWindow),
                                           describe(b_.dataWindow)));
        return allowed_.contains(areWhole ? "size" : "data-window");
    }

    // A file that does not say means Rec. 709, as EXR does by its specification and sRGB does.
    void compareChromaticities() {
        constexpr std::array kRec709{0.64f, 0.33f, 0.3f, 0.6f, 0.15f, 0.06f, 0.3127f, 0.329f};
        constexpr float kRounding = 1e-5f; // PNG stores five decimals
        const auto a = a_.chromaticities.value_or(kRec709), b = b_.chromaticities.value_or(kRec709);
        for (std::size_t i = 0; i < a.size(); ++i)
            if (!(std::abs(a[i] - b[i]) <= kRounding))
                return add("chromaticities", fmt::format("chromaticities differ: {:g} against {:g}",
                                                         fmt::join(a, " "), fmt::join(b, " ")));
    }

    void compareCamera(const char* name) {
        const auto textOf = [&](const PicturePart& part) {
            const auto found = part.camera.find(name);
            return found == part.camera.end() ? std::string("none") : found->second;
        };
        if (textOf(a_) != textOf(b_))
            add("camera", fmt::format("{} differs: {} against {}", name, textOf(a_), textOf(b_)));
    }

    void compareMatrix(const char* name) {
        const auto inA = a_.image.matrices.find(name), inB = b_.image.matrices.find(name);
        const bool hasA = inA != a_.image.matrices.end(), hasB = inB != b_.image.matrices.end();
        if (!hasA && !hasB) return;
        if (!hasA || !hasB)
            return add("camera", fmt::format("only the {} image has the camera matrix {}",
                                             hasA ? "first" : "second", name));
        for (std::size_t i = 0; i < inA->second.size(); ++i)
            if (!(inA->second[i] == inB->second[i]))
                return add("camera",
                           fmt::format("camera matrix {} differs, first in row {}, column {}: {:g} against "
                                       "{:g}",
                                       name, i / 4, i % 4, inA->second[i], inB->second[i]));
    }

    const PicturePart &a_, &b_;
    std::string prefix_;
    const std::set<std::string>& allowed_;
    std::vector<Finding>& findings_;
};

bool allNamed(const Picture& picture) {
    return std::ranges::none_of(picture.parts, [](const PicturePart& part) { return part.name.empty(); });
}

// Puts the parts of b into the order of a's; parts that only one has go to the end and are named.
std::size_t matchParts(Picture& a, Picture& b, bool allowed, std::vector<Finding>& findings) {
    if (a.parts.size() == 1 && b.parts.size() == 1) return 1;
    const auto add = [&](const std::string& text) { findings.push_back({"parts", text, !allowed}); };
    if (a.parts.size() != b.parts.size())
        add(fmt::format("numbers of parts differ: {} against {}", a.parts.size(), b.parts.size()));
    if (!allNamed(a) || !allNamed(b)) return std::min(a.parts.size(), b.parts.size());
    std::size_t matched = 0;
    for (std::size_t i = 0; i < a.parts.size(); ++i) {
        const auto rest = b.parts.begin() + static_cast<std::ptrdiff_t>(matched);
        const auto same = std::find_if(rest, b.parts.end(),
                                       [&](const PicturePart& part) { return part.name == a.parts[i].name; });
        if (same == b.parts.end()) {
            add(fmt::format("part {} is in the first image only", a.parts[i].name));
            continue;
        }
        std::iter_swap(rest, same);
        std::swap(a.parts[matched++], a.parts[i]);
    }
    for (std::size_t i = matched; i < b.parts.size(); ++i)
        add(fmt::format("part {} is in the second image only", b.parts[i].name));
    return matched;
}

void decodeToLinear(Picture& picture) {
    if (picture.scale == ValueScale::Linear) return;
    for (PicturePart& part : picture.parts)
        for (ImageChannel& channel : part.image.channels)
            if (channel.name != "A")
                for (float& value : channel.values) value = static_cast<float>(decodeSrgb(value));
    picture.scale = ValueScale::Linear;
}

// Whether the values of the pictures mean the same.
bool matchScales(Picture& a, Picture& b, bool allowed, std::vector<Finding>& findings) {
    if (a.scale == b.scale) return true;
    findings.push_back(
        {"encoding",
         fmt::format("encodings differ: {} holds {}, {} {}", a.format,
                     a.scale == ValueScale::Linear ? "linear light" : "display values", b.format,
                     b.scale == ValueScale::Linear ? "linear light" : "display values"),
         !allowed});
    if (!allowed) return false;
    decodeToLinear(a);
    decodeToLinear(b);
    return true;
}

void ignoreRectangles(const std::vector<PixelBox>& rectangles, Focus& focus) {
    for (const PixelBox& rectangle : rectangles) {
        const PixelBox box = intersection(rectangle, focus.box);
        for (std::int32_t y = box.y0; y < box.y1; ++y)
            std::fill_n(focus.ignored.begin() + std::ptrdiff_t(y - focus.box.y0) * focus.box.width() +
                            (box.x0 - focus.box.x0),
                        box.width(), std::uint8_t(1));
    }
}

// A mask's channels that count: numbers without opacity, or uint where there are no others.
std::vector<const ImageChannel*> maskChannels(const Image& mask) {
    std::vector<const ImageChannel*> numbers, ids;
    for (const ImageChannel& channel : mask.channels)
        if (channel.type == ImageChannel::Type::Uint)
            ids.push_back(&channel);
        else if (channel.name != "A" || mask.channels.size() == 1)
            numbers.push_back(&channel);
    return numbers.empty() ? ids : numbers;
}

// `whole` is the pictures' box before the crop, which the mask must have too.
void ignoreMasked(const Picture& mask, const PixelBox& whole, Focus& focus) {
    const Image& image = mask.parts.front().image;
    if (image.width != whole.width() || image.height != whole.height())
        throw Error(ErrorKind::InvalidContent,
                    fmt::format("{}: a mask of {} x {} pixels does not fit images of {} x {}", mask.name,
                                image.width, image.height, whole.width(), whole.height()));
    const std::vector<const ImageChannel*> channels = maskChannels(image);
    for (std::size_t i = 0; i < focus.ignored.size(); ++i) {
        const std::size_t x = i % focus.box.width() + std::size_t(focus.box.x0 - whole.x0);
        const std::size_t y = i / focus.box.width() + std::size_t(focus.box.y0 - whole.y0);
        const std::size_t at = y * image.width + x;
        bool isShown = false;
        for (const ImageChannel* channel : channels) {
            const double value =
                channel->values.empty() ? double(channel->uints[at]) : double(channel->values[at]);
            if (!std::isfinite(value))
                throw Error(ErrorKind::InvalidContent,
                            fmt::format("{}: the mask is not finite at x {}, y {}", mask.name, x, y));
            isShown = isShown || value != 0.0;
        }
        if (!isShown) focus.ignored[i] = 1;
    }
}

Focus focusOf(const PixelBox& a, const PixelBox& b, const FocusOptions& options) {
    const PixelBox whole = unionOf(a, b);
    Focus focus;
    focus.box = options.crop ? intersection(*options.crop, whole) : whole;
    if (focus.box.pixelCount() == 0) focus.box = {};
    // Windows that are far from each other may span more than either file holds.
    constexpr std::uint64_t kMaxPixels = std::uint64_t(1) << 28;
    const std::uint64_t most = std::max({kMaxPixels, a.pixelCount(), b.pixelCount()});
    if (focus.box.pixelCount() > most)
        throw Error(
            ErrorKind::LimitExceeded,
            fmt::format("the data windows span {} x {} pixels, more than {}; compare a part with --crop",
                        focus.box.width(), focus.box.height(), most));
    if (options.ignored.empty() && !options.mask) return focus;
    focus.ignored.resize(focus.box.pixelCount());
    ignoreRectangles(options.ignored, focus);
    if (options.mask) ignoreMasked(*options.mask, whole, focus);
    focus.ignoredCount = static_cast<std::uint64_t>(std::ranges::count(focus.ignored, std::uint8_t(1)));
    return focus;
}

std::string prefixOf(const Picture& picture, std::size_t part) {
    if (picture.parts.size() == 1) return {};
    const std::string& name = picture.parts[part].name;
    return (name.empty() ? std::to_string(part) : name) + "/";
}

} // namespace

const ChannelPair* LayerPair::find(const std::string& lastName) const {
    for (const ChannelPair& channel : channels)
        if (splitChannelName(channel.a->name).last == lastName) return &channel;
    return nullptr;
}

void moveTo(PicturePart& part, const PixelBox& box) {
    if (part.dataWindow == box) return;
    for (ImageChannel& channel : part.image.channels) {
        moveValues(channel.values, part.dataWindow, box);
        moveValues(channel.uints, part.dataWindow, box);
    }
    part.dataWindow = box;
    part.image.width = box.width();
    part.image.height = box.height();
}

PreparedPair preparePair(Picture&& a, Picture&& b, const FocusOptions& options,
                         const std::set<std::string>& allowed, std::vector<Finding>& findings) {
    PreparedPair pair{std::move(a), std::move(b), {}, {}};
    for (Picture* picture : {&pair.a, &pair.b})
        for (PicturePart& part : picture->parts) selectChannels(part.image, options);
    const std::size_t parts = matchParts(pair.a, pair.b, allowed.contains("parts"), findings);
    bool comparable = matchScales(pair.a, pair.b, allowed.contains("encoding"), findings);
    for (std::size_t i = 0; i < parts; ++i)
        comparable &=
            PartComparer(pair.a.parts[i], pair.b.parts[i], prefixOf(pair.a, i), allowed, findings).run();
    if (!comparable) return pair;

    std::uint64_t pixels = 0;
    for (std::size_t i = 0; i < parts; ++i) {
        PicturePart &partA = pair.a.parts[i], &partB = pair.b.parts[i];
        pair.focus.push_back(focusOf(partA.dataWindow, partB.dataWindow, options));
        for (PicturePart* part : {&partA, &partB}) {
            moveTo(*part, pair.focus.back().box);
            clearIgnored(*part, pair.focus.back());
        }
        pixels += pair.focus.back().box.pixelCount() - pair.focus.back().ignoredCount;
    }
    for (std::size_t i = 0; i < parts; ++i)
        for (LayerPair& layer :
             pairLayers(pair.a.parts[i].image, pair.b.parts[i].image, i, prefixOf(pair.a, i)))
            if (pixels > 0) pair.layers.push_back(std::move(layer));
    if (pixels == 0)
        findings.push_back(
            {"nothing", "no pixel is left to compare after --crop, --mask and --ignore", true});
    return pair;
}

} // namespace rt

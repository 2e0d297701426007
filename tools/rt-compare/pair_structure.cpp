#include "tools/rt-compare/pair_structure.h"

#include "formats/image_attributes.h"
#include "tools/rt-compare/layers.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rt {
namespace {

std::string describe(const PixelBox& box) {
    return fmt::format("{},{},{},{}", box.x0, box.y0, box.x1, box.y1);
}

bool allNamed(const Picture& picture) {
    return std::ranges::none_of(picture.parts, [](const PicturePart& part) { return part.name.empty(); });
}

void decodeToLinear(Picture& picture) {
    if (picture.scale == ValueScale::Linear) return;
    for (PicturePart& part : picture.parts)
        for (ImageChannel& channel : part.image.channels)
            if (channel.name != "A")
                for (float& value : channel.values) value = static_cast<float>(decodeSrgb(value));
    picture.scale = ValueScale::Linear;
}

} // namespace

std::size_t StructureComparer::matchParts(Picture& a, Picture& b) {
    if (a.parts.size() == 1 && b.parts.size() == 1) return 1;
    if (a.parts.size() != b.parts.size())
        add(FindingKind::Parts,
            fmt::format("numbers of parts differ: {} against {}", a.parts.size(), b.parts.size()));
    if (!allNamed(a) || !allNamed(b)) return std::min(a.parts.size(), b.parts.size());
    std::size_t matched = 0;
    for (std::size_t i = 0; i < a.parts.size(); ++i) {
        const auto rest = b.parts.begin() + static_cast<std::ptrdiff_t>(matched);
        const auto same = std::find_if(rest, b.parts.end(),
                                       [&](const PicturePart& part) { return part.name == a.parts[i].name; });
        if (same == b.parts.end()) {
            add(FindingKind::Parts, fmt::format("part {} is in the first image only", a.parts[i].name));
            continue;
        }
        std::iter_swap(rest, same);
        std::swap(a.parts[matched++], a.parts[i]);
    }
    for (std::size_t i = matched; i < b.parts.size(); ++i)
        add(FindingKind::Parts, fmt::format("part {} is in the second image only", b.parts[i].name));
    return matched;
}

bool StructureComparer::matchScales(Picture& a, Picture& b) {
    if (a.scale == b.scale) return true;
    const auto holds = [](const Picture& picture) {
        return picture.scale == ValueScale::Linear ? "linear light" : "display values";
    };
    add(FindingKind::Encoding,
        fmt::format("encodings differ: {} holds {}, {} {}", a.format, holds(a), b.format, holds(b)));
    if (!isAllowed(FindingKind::Encoding)) return false;
    decodeToLinear(a);
    decodeToLinear(b);
    return true;
}

void StructureComparer::add(FindingKind kind, const std::string& text) {
    findings_.push_back({kind, where_ + text, !isAllowed(kind)});
}

bool StructureComparer::compareParts(const PicturePart& a, const PicturePart& b, const std::string& prefix) {
    where_ = prefix.empty() ? "" : "part " + prefix.substr(0, prefix.size() - 1) + ": ";
    const bool comparable = compareWindows(a, b);
    if (a.pixelAspect != b.pixelAspect)
        add(FindingKind::PixelAspect,
            fmt::format("pixel aspects differ: {:g} against {:g}", a.pixelAspect, b.pixelAspect));
    compareChromaticities(a, b);
    for (const char* name : {kWorldToCameraKey, kWorldToNdcKey}) compareMatrix(a, b, name);
    for (const char* name : {"screenWindowWidth", "screenWindowCenter", "view", "envmap"})
        compareCamera(a, b, name);
    where_.clear(); // the names of channels have the prefix already
    for (const std::string& text : describeChannelDifferences(a.image, b.image, prefix))
        add(FindingKind::Channels, text);
    return comparable;
}

bool StructureComparer::compareWindows(const PicturePart& a, const PicturePart& b) {
    const PixelBox &sizeA = a.displayWindow, &sizeB = b.displayWindow;
    if (sizeA.width() != sizeB.width() || sizeA.height() != sizeB.height())
        add(FindingKind::Size, fmt::format("sizes differ: {} x {} against {} x {}", sizeA.width(),
                                           sizeA.height(), sizeB.width(), sizeB.height()));
    else if (sizeA != sizeB)
        add(FindingKind::Size,
            fmt::format("display windows differ: {} against {}", describe(sizeA), describe(sizeB)));
    if (a.dataWindow == b.dataWindow) return true;
    const bool areWhole = a.dataWindow == sizeA && b.dataWindow == sizeB; // said by the size already
    if (!areWhole)
        add(FindingKind::DataWindow, fmt::format("data windows differ: {} against {}", describe(a.dataWindow),
                                                 describe(b.dataWindow)));
    return isAllowed(areWhole ? FindingKind::Size : FindingKind::DataWindow);
}

// A file that does not say means Rec. 709, as EXR does by its specification and sRGB does.
void StructureComparer::compareChromaticities(const PicturePart& a, const PicturePart& b) {
    constexpr std::array kRec709{0.64f, 0.33f, 0.3f, 0.6f, 0.15f, 0.06f, 0.3127f, 0.329f};
    constexpr float kRounding = 1e-5f; // PNG stores five decimals
    const auto inA = a.chromaticities.value_or(kRec709), inB = b.chromaticities.value_or(kRec709);
    for (std::size_t i = 0; i < inA.size(); ++i)
        if (!(std::abs(inA[i] - inB[i]) <= kRounding))
            return add(FindingKind::Chromaticities, fmt::format("chromaticities differ: {:g} against {:g}",
                                                                fmt::join(inA, " "), fmt::join(inB, " ")));
}

void StructureComparer::compareCamera(const PicturePart& a, const PicturePart& b, const char* name) {
    const auto textOf = [&](const PicturePart& part) {
        const auto found = part.camera.find(name);
        return found == part.camera.end() ? std::string("none") : found->second;
    };
    if (textOf(a) != textOf(b))
        add(FindingKind::Camera, fmt::format("{} differs: {} against {}", name, textOf(a), textOf(b)));
}

void StructureComparer::compareMatrix(const PicturePart& a, const PicturePart& b, const char* name) {
    const auto inA = a.image.matrices.find(name), inB = b.image.matrices.find(name);
    const bool hasA = inA != a.image.matrices.end(), hasB = inB != b.image.matrices.end();
    if (!hasA && !hasB) return;
    if (!hasA || !hasB)
        return add(FindingKind::Camera, fmt::format("only the {} image has the camera matrix {}",
                                                    hasA ? "first" : "second", name));
    for (std::size_t i = 0; i < inA->second.size(); ++i)
        if (!(inA->second[i] == inB->second[i]))
            return add(FindingKind::Camera,
                       fmt::format("camera matrix {} differs, first in row {}, column {}: {:g} against "
                                   "{:g}",
                                   name, i / 4, i % 4, inA->second[i], inB->second[i]));
}

} // namespace rt

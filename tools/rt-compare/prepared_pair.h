#pragma once
#include "tools/rt-compare/comparison.h"

#include <array>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace rt {

struct ChannelPair {
    std::string name; ///< as in ChannelComparison
    const ImageChannel* a = nullptr;
    const ImageChannel* b = nullptr; ///< of the same size and kind (numbers or uint) as a
};

/// The channels of one LayerComparison. Channels of color layers stand in the order R, G, B, A, or Y, A.
struct LayerPair {
    std::size_t part = 0; ///< index in PreparedPair::focus
    std::string name;
    LayerKind kind = LayerKind::Color;
    std::vector<ChannelPair> channels;

    /// By the last part of the channel's name: "R" finds "albedo.R"; nullptr if absent.
    const ChannelPair* find(const std::string& lastName) const;
};

/// Which pixels of a part are compared.
struct Focus {
    PixelBox box;                      ///< what the channels of the part hold: width*height values each
    std::vector<std::uint8_t> ignored; ///< 1 = not compared, one per pixel of the box; empty: all are
    std::uint64_t ignoredCount = 0;
};

/// Two pictures that were cut to the same pixels: what a mask takes out is 0 in both.
struct PreparedPair {
    Picture a, b;                  ///< after crop, padding and mask
    std::vector<Focus> focus;      ///< for each pair of parts
    std::vector<LayerPair> layers; ///< in the order of Comparison::layers; points into a and b
};

/// Which parts of the pictures to compare.
struct FocusOptions {
    std::optional<PixelBox> crop;
    std::vector<PixelBox> ignored;
    const Picture* mask = nullptr; ///< pixels where all its channels (not A) are 0 are not compared
    std::vector<std::string> onlyChannels, withoutChannels; ///< names of channels or layers; empty: all, none
};

/// Names what `a` and `b` differ in beside their values, as findings that fail unless their kind is in
/// `allowed`, and cuts both to the pixels to be compared. Where a differing data window is allowed, pixels
/// outside of one are 0. Where the pictures cannot be compared, no layers come out. Throws
/// Error{InvalidContent} if the mask does not have their size or is not finite.
PreparedPair preparePair(Picture&& a, Picture&& b, const FocusOptions& options,
                         const std::set<std::string>& allowed, std::vector<Finding>& findings);

/// Cuts a part to the pixels of `box`, or fills it up with zeros.
void moveTo(PicturePart& part, const PixelBox& box);

/// What --allow takes, in the order of the help text.
inline constexpr std::array kAllowable{"size",         "data-window",    "parts",  "channels",
                                       "pixel-aspect", "chromaticities", "camera", "encoding",
                                       "black",        "files"};

} // namespace rt

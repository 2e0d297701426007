#pragma once
#include <array>
#include <set>
#include <string>

namespace rt {

/// What pictures may differ in, or what may be wrong with them.
enum class FindingKind {
    Size,
    DataWindow,
    Parts,
    Channels,
    PixelAspect,
    Chromaticities,
    Camera,
    Encoding,
    Black,
    Files,
    NonFinite,
    Limit,
    Noise,
    Nothing
};

/// All that options and reports know of a kind.
struct FindingTraits {
    FindingKind kind;
    const char* name; ///< in every report, and for --allow
    const char* help;
    bool isAllowable; ///< by --allow
};

/// In the order of FindingKind.
inline constexpr std::array<FindingTraits, 14> kFindings{{
    {FindingKind::Size, "size", "width, height or display window", true},
    {FindingKind::DataWindow, "data-window", "what is outside of one counts as 0", true},
    {FindingKind::Parts, "parts", "parts that only one has", true},
    {FindingKind::Channels, "channels", "channels that only one has", true},
    {FindingKind::PixelAspect, "pixel-aspect", "width of a pixel over its height", true},
    {FindingKind::Chromaticities, "chromaticities", "what the colors mean", true},
    {FindingKind::Camera, "camera", "matrices, screen window, view", true},
    {FindingKind::Encoding, "encoding", "linear light against sRGB, which is decoded", true},
    {FindingKind::Black, "black", "layers that are black in one only", true},
    {FindingKind::Files, "files", "files that only one folder has", true},
    {FindingKind::NonFinite, "non-finite", "NaN and infinities", false},
    {FindingKind::Limit, "limit", "a limit is broken", false},
    {FindingKind::Noise, "noise", "differences beyond noise", false},
    {FindingKind::Nothing, "nothing", "there is nothing to compare", false},
}};

constexpr const FindingTraits& traitsOf(FindingKind kind) {
    return kFindings[static_cast<std::size_t>(kind)];
}
static_assert([] {
    for (std::size_t i = 0; i < kFindings.size(); ++i)
        if (kFindings[i].kind != static_cast<FindingKind>(i)) return false;
    return kFindings.back().kind == FindingKind::Nothing;
}());

using AllowedKinds = std::set<FindingKind>;

/// One thing that was found.
struct Finding {
    FindingKind kind;
    std::string text;  ///< for people, whole
    bool fails = true; ///< else it is allowed
};

} // namespace rt

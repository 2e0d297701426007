#pragma once
#include <optional>
#include <string>

namespace rt {

/// Pictures of which the first and the last have these numbers.
struct FrameRange {
    unsigned first = 0, last = 0;
};

/// "A-B" or "A". Throws Error{Usage}.
FrameRange parseFrames(const std::string& text);

/// The path with its %d or %04d replaced by the frame's number; nothing unless there is exactly one.
std::optional<std::string> framePath(const std::string& path, unsigned frame);

} // namespace rt

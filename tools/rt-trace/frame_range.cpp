#include "tools/rt-trace/frame_range.h"

#include "common/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

namespace rt {

FrameRange parseFrames(const std::string& text) {
    FrameRange frames;
    const char* const end = text.data() + text.size();
    const auto first = std::from_chars(text.data(), end, frames.first);
    frames.last = frames.first;
    bool good = first.ec == std::errc();
    const char* at = first.ptr;
    if (good && at != end && *at == '-') {
        const auto last = std::from_chars(at + 1, end, frames.last);
        good = last.ec == std::errc();
        at = last.ptr;
    }
    if (!good || at != end || frames.last < frames.first)
        throw Error(ErrorKind::Usage, fmt::format("--frames: '{}' is not a range such as 1-48", text));
    return frames;
}

std::optional<std::string> framePath(const std::string& path, unsigned frame) {
    const std::size_t at = path.find('%');
    if (at == std::string::npos || path.find('%', at + 1) != std::string::npos) return std::nullopt;
    std::size_t end = at + 1;
    unsigned digits = 0;
    const bool padded = end < path.size() && path[end] == '0';
    for (; end < path.size() && path[end] >= '0' && path[end] <= '9' && end < at + 4; ++end)
        digits = digits * 10 + static_cast<unsigned>(path[end] - '0');
    if (end >= path.size() || path[end] != 'd' || (digits > 0 && !padded)) return std::nullopt;
    return path.substr(0, at) + fmt::format("{:0{}}", frame, std::max(digits, 1u)) + path.substr(end + 1);
}

} // namespace rt

#include "tools/rt-import/check_collada.h"

#include "common/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <map>

namespace rt {
namespace {

// The value of an attribute in the text of a tag; empty if there is none.
std::string_view attribute(std::string_view tag, std::string_view name) {
    for (std::size_t at = tag.find(name); at != std::string_view::npos; at = tag.find(name, at + 1)) {
        const std::string_view rest = tag.substr(at + name.size());
        const bool isWhole =
            at > 0 && std::string_view(" \t\r\n").find(tag[at - 1]) != std::string_view::npos;
        if (!isWhole || rest.size() < 2 || rest[0] != '=' || (rest[1] != '"' && rest[1] != '\'')) continue;
        return rest.substr(2, std::min(rest.find(rest[1], 2), rest.size()) - 2);
    }
    return {};
}

std::uint64_t numberOr(std::string_view text, std::uint64_t fallback) {
    std::uint64_t number = 0;
    const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), number);
    return status == std::errc() ? number : fallback;
}

// Calls visit(tag) for the text of each tag that starts so.
template <class Visit>
void forEachTag(std::string_view text, std::string_view start, Visit visit) {
    for (std::size_t at = text.find(start); at != std::string_view::npos; at = text.find(start, at + 1))
        visit(text.substr(at, text.find('>', at) - at));
}

} // namespace

void checkCollada(std::string_view text, const std::string& path) {
    std::map<std::string_view, std::uint64_t> counts;
    forEachTag(text, "<float_array", [&](std::string_view tag) {
        counts[attribute(tag, "id")] = numberOr(attribute(tag, "count"), 0);
    });
    forEachTag(text, "<accessor", [&](std::string_view tag) {
        std::string_view source = attribute(tag, "source");
        if (!source.empty() && source.front() == '#') source.remove_prefix(1);
        const auto array = counts.find(source);
        if (array == counts.end()) return;
        const std::uint64_t count = numberOr(attribute(tag, "count"), 0);
        const std::uint64_t stride = numberOr(attribute(tag, "stride"), 1);
        const std::uint64_t offset = numberOr(attribute(tag, "offset"), 0);
        // Divided, for a product may overflow.
        const std::uint64_t room = array->second - std::min(offset, array->second);
        if (stride == 0 || count <= room / stride) return;
        throw Error(
            ErrorKind::InvalidContent,
            fmt::format("{}: an accessor reads {} times {} numbers of array '{}', which has {}; correct "
                        "its count",
                        path, count, stride, source, array->second));
    });
}

} // namespace rt

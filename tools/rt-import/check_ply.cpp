#include "tools/rt-import/check_ply.h"

#include "common/error.h"

namespace rt {

void checkPly(std::string_view bytes, const std::string& path) {
    constexpr std::size_t kMostHeaderBytes = 1u << 20;
    constexpr std::string_view kEnd = "end_header", kBlanks = " \t", kLineEnds = "\r\n";
    const std::string_view header = bytes.substr(0, kMostHeaderBytes);
    for (std::size_t at = header.find(kEnd); at != std::string_view::npos; at = header.find(kEnd, at + 1)) {
        const std::size_t before = header.substr(0, at).find_last_not_of(kBlanks);
        const std::size_t behind = header.find_first_not_of(kBlanks, at + kEnd.size());
        const bool begins =
            before != std::string_view::npos && kLineEnds.find(header[before]) != kLineEnds.npos;
        const bool ends =
            behind == std::string_view::npos || kLineEnds.find(header[behind]) != kLineEnds.npos;
        if (begins && ends) return;
    }
    throw Error(ErrorKind::InvalidContent,
                path +
                    ": its header has no line 'end_header' within the first 1048576 bytes; the file is cut "
                    "short or damaged: get a whole copy of it");
}

} // namespace rt

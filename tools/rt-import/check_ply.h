#pragma once
#include <string>
#include <string_view>

namespace rt {

/// Assimp looks for ever for the end of a PLY file's header where there is none. Throws
/// Error{InvalidContent}, message prefixed by `path`, if no line of the first MiB is "end_header".
void checkPly(std::string_view bytes, const std::string& path);

} // namespace rt

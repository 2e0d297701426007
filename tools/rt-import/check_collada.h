#pragma once
#include <string>
#include <string_view>

namespace rt {

/// Assimp believes a COLLADA file's accessors, and gives what lies behind an array in its memory for numbers
/// of it. Throws Error{InvalidContent}, message prefixed by `path`, for an accessor that reads more numbers
/// than its array says it has.
void checkCollada(std::string_view text, const std::string& path);

} // namespace rt

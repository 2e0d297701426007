#pragma once
#include <fstream>
#include <iterator>
#include <string>

namespace rt::test {

/// The bytes of a file; empty if it is absent.
inline std::string readText(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

} // namespace rt::test

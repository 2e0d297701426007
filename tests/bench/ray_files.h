// Rays and hits in files as rt-trace reads and writes them.
#pragma once
#include "common/binary_io.h"
#include "common/error.h"

#include <fmt/format.h>

#include <span>
#include <string>

namespace rt::bench {

/// Throws Error{InvalidContent} if the bytes of the file `path` are not a whole number of records.
template <class T>
std::span<const T> recordsOf(const SharedSpan<std::byte>& bytes, const std::string& path) {
    if (bytes.size() % sizeof(T) != 0)
        throw Error(ErrorKind::InvalidContent,
                    fmt::format("{}: {} bytes are not a whole number of records of {}", path, bytes.size(),
                                sizeof(T)));
    return {reinterpret_cast<const T*>(bytes.data()), bytes.size() / sizeof(T)};
}

} // namespace rt::bench

#pragma once
#include "common/error.h"
#include "formats/picture.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace rt::test {

using Bytes = std::vector<std::byte>;

inline Picture decode(const Bytes& bytes, const PictureLimits& limits = {}) {
    return decodePicture(bytes, "test", limits);
}

inline std::pair<ErrorKind, std::string> errorOf(const Bytes& bytes, const PictureLimits& limits = {}) {
    try {
        decode(bytes, limits);
    } catch (const Error& error) {
        return {error.kind(), error.what()};
    }
    ADD_FAILURE() << "decoding succeeded";
    return {};
}

inline const std::vector<float>& channel(const Picture& picture, const char* name, std::size_t part = 0) {
    const ImageChannel* found = picture.parts.at(part).image.find(name);
    if (!found) throw std::runtime_error(std::string("no channel ") + name);
    return found->values;
}

/// What truncating and changing must never do: anything but being read or refused.
inline void expectSafe(const Bytes& bytes, std::size_t step) {
    for (std::size_t size = 0; size < bytes.size(); size += step)
        EXPECT_EQ(errorOf(Bytes(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size))).first,
                  ErrorKind::InvalidContent)
            << size << " of " << bytes.size();
    for (std::size_t at = 0; at < bytes.size(); at += step) {
        for (const unsigned mask : {0x01u, 0xFFu}) {
            Bytes changed = bytes;
            changed[at] ^= std::byte(mask);
            try {
                decode(changed);
            } catch (const Error& error) {
                EXPECT_NE(error.kind(), ErrorKind::Internal);
            }
        }
    }
}

} // namespace rt::test

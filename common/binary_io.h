#pragma once
#include <bit>
#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace rt {

static_assert(std::endian::native == std::endian::little, "files are little-endian and mapped as they are");

/// Read-only array that keeps alive what it points into: a vector it was made from, or a mapped file.
template <class T>
class SharedSpan : public std::span<const T> {
public:
    SharedSpan() = default;
    SharedSpan(std::vector<T>&& values)
        : SharedSpan(std::make_shared<const std::vector<T>>(std::move(values))) {}
    SharedSpan(std::span<const T> view, std::shared_ptr<const void> owner)
        : std::span<const T>(view), owner_(std::move(owner)) {}

private:
    explicit SharedSpan(std::shared_ptr<const std::vector<T>> values)
        : std::span<const T>(*values), owner_(std::move(values)) {}
    std::shared_ptr<const void> owner_;
};

template <class T>
std::span<const std::byte> bytesOf(std::span<const T> values) {
    static_assert(std::is_trivially_copyable_v<T>);
    return std::as_bytes(values);
}

/// Maps a file read-only; "-" reads standard input into memory.
/// Throws Error{FileAccess} if it cannot be opened, is a directory, or shrinks while it is mapped.
SharedSpan<std::byte> readFile(const std::string& path);

/// Writes the file whole or not at all: an unnamed (or, where the file system has none, a temporary) file
/// beside it is written, synced and renamed over it. A file that already holds these bytes keeps its time
/// stamp. "-" is standard output; devices and pipes are written straight. Throws Error{FileAccess}.
void writeFile(const std::string& path, std::span<const std::span<const std::byte>> chunks);
void writeFile(const std::string& path, std::span<const std::byte> bytes);
void writeFile(const std::string& path, std::string_view text);

} // namespace rt

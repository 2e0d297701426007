#pragma once
#include "common/memory_limit.h"

#include <bit>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
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

/// How far to read a stream, which may have no end: standard input, a pipe or a device.
struct StreamRule {
    std::size_t headBytes = 0;
    /// Is given the first headBytes, or all if there are fewer. Throws if the rest is not worth reading.
    /// Returns how long the stream should be; nothing where that is not known.
    std::function<std::optional<std::uint64_t>(std::span<const std::byte> head)> lengthOf;
    std::optional<MemoryLimit> memory; ///< nothing: defaultMemoryLimit()
};

/// Maps a file read-only; "-" reads standard input into memory, as other streams are. Of a stream that is
/// longer than rule.lengthOf() says, one byte more is read, to show that.
/// Throws Error{FileAccess} if it cannot be opened or is a directory, Error{LimitExceeded} if a stream, or
/// what lengthOf() says of it, exceeds rule.memory. If the file shrinks while it is mapped,
/// reading the lost part raises SIGBUS, for which runTool() ends the program with the exit code of
/// FileAccess.
SharedSpan<std::byte> readFile(const std::string& path, const StreamRule& rule = {});

/// What messages call an input: "-" is standard input.
std::string inputName(const std::string& path);

/// A file to write.
struct OutputFile {
    std::string path;
    std::vector<std::span<const std::byte>> chunks;
};

/// Writes all of the files whole or, where one cannot be written, none: an unnamed (or, where the system has
/// none, a temporary) file is written beside each and synced; then they are renamed over what was there. A
/// replaced file's permissions stay. A file that already holds these bytes keeps its time stamp. "-" is
/// standard output; that, devices and pipes are written straight, before the files get their names. Not for
/// several threads at a time. Throws Error{FileAccess}.
void writeFiles(const std::vector<OutputFile>& outputs);
void writeFile(const std::string& path, std::span<const std::span<const std::byte>> chunks);
void writeFile(const std::string& path, std::span<const std::byte> bytes);
void writeFile(const std::string& path, std::string_view text);

/// Throws Error{FileAccess} if writeFile() would certainly fail: no such folder, no right to write there, or
/// the path is a folder. For tools to ask of all outputs before they do the work. Nothing is touched.
void requireWritable(const std::string& path);

/// Removes the temporary files that a running writeFiles() has made, if any. For signal handlers:
/// async-signal-safe.
void removeUnfinishedFiles();

} // namespace rt

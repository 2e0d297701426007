#include "common/binary_io.h"

#include "common/error.h"
#include "common/file_descriptor.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

namespace rt {
namespace {

// Memory that grows without being copied, so that no more than its bytes is ever taken.
class StreamBuffer {
public:
    StreamBuffer() = default;
    ~StreamBuffer() {
        if (memory_ != MAP_FAILED) munmap(memory_, capacity_);
    }
    StreamBuffer(const StreamBuffer&) = delete;
    StreamBuffer& operator=(const StreamBuffer&) = delete;

    std::span<const std::byte> bytes() const {
        return {static_cast<const std::byte*>(size_ > 0 ? memory_ : nullptr), size_};
    }
    // Reads until there are `size` bytes. False if the stream ends before.
    bool readUpTo(std::uint64_t size, int fd, const std::string& path) {
        while (size_ < size) {
            if (size_ == capacity_) grow(path);
            const std::size_t room = std::min<std::uint64_t>(size, capacity_) - size_;
            const ssize_t got = read(fd, static_cast<std::byte*>(memory_) + size_, room);
            if (got < 0 && errno == EINTR) continue;
            if (got < 0) throwSystem(path, "read");
            if (got == 0) return false;
            size_ += static_cast<std::size_t>(got);
        }
        return true;
    }

private:
    void grow(const std::string& path) {
        constexpr std::size_t kFirst = 1u << 20;
        const std::size_t larger = capacity_ == 0 ? kFirst : 2 * capacity_;
        void* const memory = capacity_ == 0 ? mmap(nullptr, larger, PROT_READ | PROT_WRITE,
                                                   MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0)
                                            : mremap(memory_, capacity_, larger, MREMAP_MAYMOVE);
        if (memory == MAP_FAILED)
            throw Error(
                ErrorKind::LimitExceeded,
                fmt::format("{}: the system has no memory for more than its first {} bytes; files are "
                            "mapped, streams are not: write it to a file",
                            path, size_));
        memory_ = memory;
        capacity_ = larger;
    }

    void* memory_ = MAP_FAILED;
    std::size_t size_ = 0;
    std::size_t capacity_ = 0;
};

SharedSpan<std::byte> readStream(int fd, const std::string& path, const StreamRule& rule) {
    const MemoryLimit memory = rule.memory.value_or(defaultMemoryLimit());
    const auto requireRoom = [&](bool fits) {
        if (!fits)
            throw Error(ErrorKind::LimitExceeded,
                        fmt::format("{}: is longer than {} bytes ({}), the most that is read from a stream; "
                                    "files are mapped: write it to a file",
                                    path, memory.bytes, memory.origin));
    };
    const auto buffer = std::make_shared<StreamBuffer>();
    bool more = buffer->readUpTo(rule.headBytes, fd, path);
    std::optional<std::uint64_t> length;
    if (rule.lengthOf) length = rule.lengthOf(buffer->bytes());
    requireRoom(length.value_or(0) <= memory.bytes);
    if (more) more = buffer->readUpTo(length.value_or(memory.bytes) + 1, fd, path);
    requireRoom(length || !more);
    return {buffer->bytes(), buffer};
}

} // namespace

FileDescriptor::~FileDescriptor() {
    if (fd_ >= 0) close(fd_);
}

void throwSystem(const std::string& path, const char* action) {
    throw Error(ErrorKind::FileAccess, fmt::format("{}: cannot {}: {}", path, action, std::strerror(errno)));
}

std::string inputName(const std::string& path) {
    return path == "-" ? "standard input" : path;
}

SharedSpan<std::byte> readFile(const std::string& path, const StreamRule& rule) {
    if (path == "-") return readStream(STDIN_FILENO, inputName(path), rule);
    const FileDescriptor file(open(path.c_str(), O_RDONLY | O_CLOEXEC));
    struct stat info {};
    if (file.get() < 0 || fstat(file.get(), &info) != 0) throwSystem(path, "open");
    if (S_ISDIR(info.st_mode)) throw Error(ErrorKind::FileAccess, path + ": is a directory, not a file");
    if (!S_ISREG(info.st_mode)) return readStream(file.get(), path, rule);
    const auto size = static_cast<std::size_t>(info.st_size);
    if (size == 0) return {};
    void* address = mmap(nullptr, size, PROT_READ, MAP_PRIVATE, file.get(), 0);
    if (address == MAP_FAILED && errno == ENOMEM)
        throw Error(
            ErrorKind::LimitExceeded,
            fmt::format("{}: memory does not suffice to map its {} bytes; raise --max-memory, where the "
                        "tool has it, or the system's limit",
                        path, size));
    if (address == MAP_FAILED) throwSystem(path, "map");
    std::shared_ptr<const void> owner(address, [size](void* p) { munmap(p, size); });
    return {std::span(static_cast<const std::byte*>(address), size), std::move(owner)};
}

} // namespace rt

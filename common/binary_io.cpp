#include "common/binary_io.h"

#include "common/error.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

namespace rt {
namespace {

[[noreturn]] void throwSystem(const std::string& path, const char* action) {
    throw Error(ErrorKind::FileAccess, fmt::format("{}: cannot {}: {}", path, action, std::strerror(errno)));
}

class FileDescriptor {
public:
    explicit FileDescriptor(int fd) : fd_(fd) {}
    ~FileDescriptor() {
        if (fd_ >= 0) close(fd_);
    }
    FileDescriptor(const FileDescriptor&) = delete;
    FileDescriptor& operator=(const FileDescriptor&) = delete;
    int get() const { return fd_; }

private:
    int fd_;
};

SharedSpan<std::byte> readStream(int fd, const std::string& path) {
    std::vector<std::byte> bytes;
    std::vector<std::byte> block(1u << 20);
    for (;;) {
        const ssize_t got = read(fd, block.data(), block.size());
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) throwSystem(path, "read");
        if (got == 0) return bytes;
        bytes.insert(bytes.end(), block.begin(), block.begin() + got);
    }
}

void writeAll(int fd, std::span<const std::byte> bytes, const std::string& path) {
    while (!bytes.empty()) {
        const ssize_t put = write(fd, bytes.data(), bytes.size());
        if (put < 0 && errno == EINTR) continue;
        if (put < 0) throwSystem(path, "write");
        bytes = bytes.subspan(static_cast<std::size_t>(put));
    }
}

bool holdsAlready(const std::string& path, std::span<const std::span<const std::byte>> chunks) {
    const FileDescriptor file(open(path.c_str(), O_RDONLY | O_CLOEXEC));
    struct stat info {};
    std::size_t total = 0;
    for (const auto& chunk : chunks) total += chunk.size();
    if (file.get() < 0 || fstat(file.get(), &info) != 0 || static_cast<std::size_t>(info.st_size) != total)
        return false;
    std::vector<std::byte> block(1u << 20);
    for (auto chunk : chunks) {
        while (!chunk.empty()) {
            const ssize_t got = read(file.get(), block.data(), std::min(block.size(), chunk.size()));
            if (got <= 0 || std::memcmp(block.data(), chunk.data(), static_cast<std::size_t>(got)) != 0)
                return false;
            chunk = chunk.subspan(static_cast<std::size_t>(got));
        }
    }
    return true;
}

std::string directoryOf(const std::string& path) {
    const std::size_t slash = path.rfind('/');
    return slash == std::string::npos ? "." : path.substr(0, slash + 1);
}

// Gives an unnamed file the temporary name it needs for the rename.
bool linkUnnamed(int fd, const std::string& name) {
    const std::string self = fmt::format("/proc/self/fd/{}", fd);
    return linkat(AT_FDCWD, self.c_str(), AT_FDCWD, name.c_str(), AT_SYMLINK_FOLLOW) == 0;
}

void replaceFile(const std::string& path, std::span<const std::span<const std::byte>> chunks, mode_t mode) {
    const std::string temporary = fmt::format("{}.tmp.{}", path, getpid());
    int fd = open(directoryOf(path).c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, mode);
    const bool unnamed = fd >= 0;
    if (!unnamed) fd = open(temporary.c_str(), O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, mode);
    if (fd < 0) throwSystem(path, "create");
    const FileDescriptor file(fd);
    struct RemoveUnlessRenamed {
        const std::string& name;
        bool exists;
        ~RemoveUnlessRenamed() {
            if (exists) unlink(name.c_str());
        }
    } guard{temporary, !unnamed};
    for (const auto& chunk : chunks) writeAll(fd, chunk, path);
    if (fsync(fd) != 0 && errno != EINVAL && errno != EROFS) throwSystem(path, "sync");
    if (unnamed) {
        if (!linkUnnamed(fd, temporary)) throwSystem(path, "name");
        guard.exists = true;
    }
    if (rename(temporary.c_str(), path.c_str()) != 0) throwSystem(path, "replace");
    guard.exists = false;
}

} // namespace

SharedSpan<std::byte> readFile(const std::string& path) {
    if (path == "-") return readStream(STDIN_FILENO, "standard input");
    const FileDescriptor file(open(path.c_str(), O_RDONLY | O_CLOEXEC));
    struct stat info {};
    if (file.get() < 0 || fstat(file.get(), &info) != 0) throwSystem(path, "open");
    if (S_ISDIR(info.st_mode)) throw Error(ErrorKind::FileAccess, path + ": is a directory, not a file");
    if (!S_ISREG(info.st_mode)) return readStream(file.get(), path);
    const auto size = static_cast<std::size_t>(info.st_size);
    if (size == 0) return {};
    void* address = mmap(nullptr, size, PROT_READ, MAP_PRIVATE, file.get(), 0);
    if (address == MAP_FAILED) throwSystem(path, "map");
    std::shared_ptr<const void> owner(address, [size](void* p) { munmap(p, size); });
    return {std::span(static_cast<const std::byte*>(address), size), std::move(owner)};
}

void writeFile(const std::string& path, std::span<const std::span<const std::byte>> chunks) {
    if (path == "-") {
        for (const auto& chunk : chunks) writeAll(STDOUT_FILENO, chunk, "standard output");
        return;
    }
    struct stat info {};
    const bool exists = stat(path.c_str(), &info) == 0;
    if (exists && S_ISDIR(info.st_mode))
        throw Error(ErrorKind::FileAccess, path + ": is a directory, not a file");
    if (exists && !S_ISREG(info.st_mode)) { // a device or a pipe cannot be replaced
        const FileDescriptor file(open(path.c_str(), O_WRONLY | O_CLOEXEC));
        if (file.get() < 0) throwSystem(path, "open");
        for (const auto& chunk : chunks) writeAll(file.get(), chunk, path);
        return;
    }
    if (exists && holdsAlready(path, chunks)) return;
    char* resolved = exists ? realpath(path.c_str(), nullptr) : nullptr; // a symbolic link stays a link
    const std::string target = resolved ? resolved : path;
    std::free(resolved);
    const mode_t mode = exists ? (info.st_mode & 07777) : 0666;
    replaceFile(target, chunks, mode);
}

void writeFile(const std::string& path, std::span<const std::byte> bytes) {
    writeFile(path, std::span<const std::span<const std::byte>>(&bytes, 1));
}

void writeFile(const std::string& path, std::string_view text) {
    writeFile(path, std::as_bytes(std::span(text)));
}

} // namespace rt

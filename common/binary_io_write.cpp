#include "common/binary_io.h"

#include "common/error.h"
#include "common/file_descriptor.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <climits>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace rt {
namespace {

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

// What removeUnfinishedFiles() has to remove.
struct UnfinishedFile {
    char path[PATH_MAX];
    std::atomic<bool> exists{false};
};
std::array<UnfinishedFile, 4> unfinishedFiles; // as many as any tool writes at a time

// A temporary file that goes unless it is renamed, by a signal too.
class TemporaryFile {
public:
    explicit TemporaryFile(std::string name) : name_(std::move(name)) {
        const auto free = std::find_if(unfinishedFiles.begin(), unfinishedFiles.end(),
                                       [](const UnfinishedFile& file) { return !file.exists; });
        if (free == unfinishedFiles.end() || name_.size() >= sizeof free->path) return;
        std::memcpy(free->path, name_.c_str(), name_.size() + 1);
        free->exists = true;
        mark_ = &free->exists;
    }
    ~TemporaryFile() {
        if (!renamed_) unlink(name_.c_str());
        if (mark_) *mark_ = false;
    }
    TemporaryFile(const TemporaryFile&) = delete;
    TemporaryFile& operator=(const TemporaryFile&) = delete;
    void renameTo(const std::string& path) {
        if (rename(name_.c_str(), path.c_str()) != 0) throwSystem(path, "replace");
        renamed_ = true;
    }

private:
    std::string name_;
    std::atomic<bool>* mark_ = nullptr;
    bool renamed_ = false;
};

// Tries make(name) with names beside `path` until one is free. Empty, and errno set, if it fails otherwise.
template <class Make>
std::string makeUnderFreeName(const std::string& path, Make&& make) {
    constexpr int kMostStaleFiles = 1000; // of killed processes that had our number
    for (int i = 0; i < kMostStaleFiles; ++i) {
        std::string name = fmt::format("{}.tmp.{}.{}", path, getpid(), i);
        if (make(name.c_str())) return name;
        if (errno != EEXIST) break;
    }
    return {};
}

struct Content {
    std::span<const std::span<const std::byte>> chunks;
    std::optional<mode_t> mode; // of the file that is replaced; none: what the umask leaves of rw-rw-rw-
    mode_t creationMode() const { return mode.value_or(0666); }
};

void writeContent(int fd, const Content& content, const std::string& path) {
    for (const auto& chunk : content.chunks) writeAll(fd, chunk, path);
    if (content.mode && fchmod(fd, *content.mode) != 0 && errno != EPERM && errno != ENOTSUP)
        throwSystem(path, "set the permissions of"); // file systems without permissions refuse: no loss there
    if (fsync(fd) != 0 && errno != EINVAL && errno != EROFS) throwSystem(path, "sync");
}

// Null where the system has no unnamed files or cannot name them: that takes /proc.
std::unique_ptr<TemporaryFile> makeUnnamed(const std::string& path, const Content& content) {
    const FileDescriptor file(
        open(directoryOf(path).c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, content.creationMode()));
    const std::string self = fmt::format("/proc/self/fd/{}", file.get());
    if (file.get() < 0 || access(self.c_str(), F_OK) != 0) return nullptr;
    writeContent(file.get(), content, path);
    std::string name = makeUnderFreeName(path, [&](const char* free) {
        return linkat(AT_FDCWD, self.c_str(), AT_FDCWD, free, AT_SYMLINK_FOLLOW) == 0;
    });
    return name.empty() ? nullptr : std::make_unique<TemporaryFile>(std::move(name));
}

std::unique_ptr<TemporaryFile> makeNamed(const std::string& path, const Content& content) {
    int fd = -1;
    std::string name = makeUnderFreeName(path, [&](const char* free) {
        fd = open(free, O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, content.creationMode());
        return fd >= 0;
    });
    if (fd < 0) throwSystem(path, "create");
    const FileDescriptor file(fd);
    auto temporary = std::make_unique<TemporaryFile>(std::move(name));
    writeContent(fd, content, path);
    return temporary;
}

// A file that is written and lacks only its name.
struct StagedFile {
    std::string path;
    std::unique_ptr<TemporaryFile> file; // null: it holds these bytes already
};

StagedFile stage(const OutputFile& output) {
    struct stat info {};
    const bool exists = stat(output.path.c_str(), &info) == 0;
    if (exists && holdsAlready(output.path, output.chunks)) return {};
    char* resolved = exists ? realpath(output.path.c_str(), nullptr) : nullptr; // a link stays a link
    const std::string path = resolved ? resolved : output.path;
    std::free(resolved);
    const Content content{output.chunks, exists ? std::optional<mode_t>(info.st_mode & 0777) : std::nullopt};
    auto unnamed = makeUnnamed(path, content);
    return {path, unnamed ? std::move(unnamed) : makeNamed(path, content)};
}

// Standard output, a device or a pipe: nothing that can be replaced.
bool isStream(const std::string& path) {
    struct stat info {};
    if (path == "-" || stat(path.c_str(), &info) != 0) return path == "-";
    if (S_ISDIR(info.st_mode)) throw Error(ErrorKind::FileAccess, path + ": is a directory, not a file");
    return !S_ISREG(info.st_mode);
}

void writeStream(const OutputFile& output) {
    const bool standard = output.path == "-";
    const FileDescriptor file(standard ? -1 : open(output.path.c_str(), O_WRONLY | O_CLOEXEC));
    if (!standard && file.get() < 0) throwSystem(output.path, "open");
    for (const auto& chunk : output.chunks)
        writeAll(standard ? STDOUT_FILENO : file.get(), chunk, standard ? "standard output" : output.path);
}

} // namespace

void writeFiles(const std::vector<OutputFile>& outputs) {
    std::vector<StagedFile> staged;
    for (const OutputFile& output : outputs)
        if (!isStream(output.path)) staged.push_back(stage(output));
    for (const OutputFile& output : outputs)
        if (isStream(output.path)) writeStream(output);
    for (const StagedFile& ready : staged)
        if (ready.file) ready.file->renameTo(ready.path);
}

void writeFile(const std::string& path, std::span<const std::span<const std::byte>> chunks) {
    writeFiles({{path, {chunks.begin(), chunks.end()}}});
}

void writeFile(const std::string& path, std::span<const std::byte> bytes) {
    writeFile(path, std::span<const std::span<const std::byte>>(&bytes, 1));
}

void writeFile(const std::string& path, std::string_view text) {
    writeFile(path, std::as_bytes(std::span(text)));
}

void requireWritable(const std::string& path) {
    if (path == "-") return;
    struct stat info {};
    const bool exists = stat(path.c_str(), &info) == 0;
    if (exists && S_ISDIR(info.st_mode))
        throw Error(ErrorKind::FileAccess, path + ": is a directory, not a file");
    const bool replaced = !exists || S_ISREG(info.st_mode); // which takes the right to write its folder
    const std::string written = replaced ? directoryOf(path) : path;
    if (access(written.c_str(), W_OK) != 0) throwSystem(path, "write");
}

void removeUnfinishedFiles() {
    for (const UnfinishedFile& file : unfinishedFiles)
        if (file.exists) unlink(file.path);
}

} // namespace rt

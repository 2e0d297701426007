#pragma once
#include <string>

namespace rt {

/// Closes it, unless it is negative.
class FileDescriptor {
public:
    explicit FileDescriptor(int fd) : fd_(fd) {}
    ~FileDescriptor();
    FileDescriptor(const FileDescriptor&) = delete;
    FileDescriptor& operator=(const FileDescriptor&) = delete;
    int get() const { return fd_; }

private:
    int fd_;
};

/// Throws Error{FileAccess} with the reason in errno.
[[noreturn]] void throwSystem(const std::string& path, const char* action);

} // namespace rt

#include "tools/rt-import/guard_process.h"

#include "common/error.h"
#include "common/progress.h"
#include "formats/mesh_file.h"
#include "tools/rt-import/sandbox.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <new>
#include <poll.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace rt {
namespace {

using Clock = std::chrono::steady_clock;
using SharedPart = std::atomic<double>;
static_assert(SharedPart::is_always_lock_free); // two processes use it

[[noreturn]] void throwNoRoom(const char* what) {
    throw Error(ErrorKind::LimitExceeded, fmt::format("cannot make {}: {}", what, std::strerror(errno)));
}

// A file in memory, or an end of a pipe.
class Descriptor {
public:
    explicit Descriptor(int fd = -1) : fd_(fd) {}
    ~Descriptor() { reset(); }
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    int get() const { return fd_; }
    std::string path() const { return fmt::format("/proc/self/fd/{}", fd_); }
    void reset(int fd = -1) {
        if (fd_ >= 0) close(fd_);
        fd_ = fd;
    }

private:
    int fd_;
};

int makeMemoryFile() {
    const int fd = memfd_create("rt-import", MFD_CLOEXEC);
    if (fd < 0) throwNoRoom("a file in memory");
    return fd;
}

void limit(int resource, rlim_t value) {
    rlimit bounds{};
    if (getrlimit(static_cast<__rlimit_resource>(resource), &bounds) != 0) return;
    bounds.rlim_cur = bounds.rlim_max = std::min(value, bounds.rlim_max);
    setrlimit(static_cast<__rlimit_resource>(resource), &bounds);
}

// Control characters, which a terminal might obey, become spaces.
void passOn(int errors) {
    constexpr int kMostBlocks = 256;
    lseek(errors, 0, SEEK_SET);
    std::array<char, 4096> block;
    ssize_t got = 0;
    for (int i = 0; i < kMostBlocks && (got = read(errors, block.data(), block.size())) > 0; ++i) {
        const auto end = block.begin() + got;
        std::replace_if(
            block.begin(), end,
            [](char c) { return c != '\n' && (static_cast<unsigned char>(c) < 0x20 || c == 0x7f); }, ' ');
        std::fwrite(block.data(), 1, static_cast<std::size_t>(got), stderr);
    }
}

} // namespace

struct GuardProcess::Impl {
    std::string name;
    GuardLimits limits;
    pid_t child = -1; // 0 in the child itself
    Descriptor errors{makeMemoryFile()}, mesh{makeMemoryFile()}, message{makeMemoryFile()};
    Descriptor lifeRead, lifeWrite; // a pipe that closes when the child ends
    SharedPart* part = nullptr;

    ~Impl();
    void start();
    void becomeChild(pid_t parent);
    bool waitForEnd();
    void throwIfKilled(int status) const;
};

GuardProcess::Impl::~Impl() {
    if (child > 0) {
        kill(child, SIGKILL);
        waitpid(child, nullptr, 0);
    }
    if (part) munmap(part, sizeof(SharedPart));
}

void GuardProcess::Impl::start() {
    std::array<int, 2> ends{};
    if (pipe2(ends.data(), O_CLOEXEC) != 0) throwNoRoom("a pipe");
    lifeRead.reset(ends[0]);
    lifeWrite.reset(ends[1]);
    void* const page =
        mmap(nullptr, sizeof(SharedPart), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (page == MAP_FAILED) throwNoRoom("a page of memory");
    part = new (page) SharedPart(0.0);
    const pid_t parent = getpid();
    child = fork();
    if (child < 0) throwNoRoom("a process");
    if (child == 0)
        becomeChild(parent);
    else
        lifeWrite.reset();
}

void GuardProcess::Impl::becomeChild(pid_t parent) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent)
        _exit(static_cast<int>(ErrorKind::Internal)); // the parent died before the line above
    dup2(errors.get(), STDERR_FILENO);
    dup2(mesh.get(), STDOUT_FILENO);
    limit(RLIMIT_CORE, 0);
#ifndef __SANITIZE_ADDRESS__ // whose shadow memory takes more address space than any machine has memory
    limit(RLIMIT_AS, limits.memory.bytes);
    limit(RLIMIT_FSIZE, limits.memory.bytes); // of the files in memory, which are no address space
    enterSandbox(limits.readable);
#endif
}

// False if the time was over before.
bool GuardProcess::Impl::waitForEnd() {
    using Milliseconds = std::chrono::milliseconds;
    constexpr Milliseconds kInterval(100);
    const Clock::time_point end = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                                     std::chrono::duration<double>(limits.seconds));
    Progress progress("", 1.0);
    pollfd life{lifeRead.get(), POLLIN, 0};
    for (;;) {
        const auto left = std::max(std::chrono::ceil<Milliseconds>(end - Clock::now()), Milliseconds(0));
        if (poll(&life, 1, static_cast<int>(std::min(left, kInterval).count())) > 0) return true;
        if (Clock::now() >= end) return false;
        progress.update(std::clamp(part->load(), 0.0, 1.0));
    }
}

void GuardProcess::Impl::throwIfKilled(int status) const {
    if (!WIFSIGNALED(status)) return;
    const int signal = WTERMSIG(status);
    const bool crashed = signal == SIGSEGV || signal == SIGABRT || signal == SIGBUS || signal == SIGFPE ||
                         signal == SIGILL || signal == SIGTRAP;
    if (crashed)
        throw Error(ErrorKind::InvalidContent,
                    fmt::format("{}: its loader crashed ({}); the file is damaged", name, strsignal(signal)));
    if (signal == SIGSYS)
        throw Error(ErrorKind::InvalidContent,
                    fmt::format("{}: its loader did what no loader needs to do and was stopped; the file is "
                                "damaged, or made to do harm",
                                name));
    if (signal == SIGXFSZ)
        throw Error(ErrorKind::LimitExceeded,
                    fmt::format("{}: what was made of it exceeds --max-memory, {} bytes ({}); it is damaged "
                                "or too large",
                                name, limits.memory.bytes, limits.memory.origin));
    throw Error(ErrorKind::LimitExceeded,
                fmt::format("{}: the process that read it was stopped from outside (signal {}, {}){}", name,
                            signal, strsignal(signal),
                            signal == SIGKILL ? "; if the system ran out of memory, lower --max-memory or "
                                                "give it more"
                                              : ""));
}

MemoryLimit readingMemoryLimit(std::uint64_t fileBytes) {
    const MemoryLimit most = defaultMemoryLimit();
    const std::uint64_t wanted = std::max(
        kLeastMemory, fileBytes > most.bytes / kMemoryPerByte ? most.bytes : fileBytes * kMemoryPerByte);
    if (wanted >= most.bytes) return most;
    return {wanted, fmt::format("the larger of 2 GiB and {} times the file", kMemoryPerByte)};
}

GuardProcess::GuardProcess(const std::string& name, const GuardLimits& limits)
    : impl_(std::make_unique<Impl>()) {
    impl_->name = name;
    impl_->limits = limits;
    impl_->start();
}

GuardProcess::~GuardProcess() = default;

bool GuardProcess::isChild() const {
    return impl_->child == 0;
}

void GuardProcess::setProgress(double part) {
    impl_->part->store(part);
}

void GuardProcess::send(const Mesh& mesh, const std::string& message) {
    writeMesh("-", mesh); // standard output is the parent's file
    for (std::size_t done = 0; done < message.size();) {
        const ssize_t put = write(impl_->message.get(), message.data() + done, message.size() - done);
        if (put < 0 && errno == EINTR) continue;
        if (put <= 0)
            throw Error(ErrorKind::LimitExceeded, fmt::format("{}: its report cannot be handed over: {}",
                                                              impl_->name, std::strerror(errno)));
        done += static_cast<std::size_t>(put);
    }
}

int GuardProcess::wait() {
    const bool inTime = impl_->waitForEnd();
    if (!inTime) kill(impl_->child, SIGKILL);
    int status = 0;
    while (waitpid(impl_->child, &status, 0) < 0 && errno == EINTR) {
    }
    impl_->child = -1;
    if (!inTime)
        throw Error(
            ErrorKind::LimitExceeded,
            fmt::format("{}: reading it took more than {:g} s; it is damaged or large: raise --max-time",
                        impl_->name, impl_->limits.seconds));
    impl_->throwIfKilled(status);
    passOn(impl_->errors.get());
    return WEXITSTATUS(status);
}

ReceivedMesh GuardProcess::receive() const {
    constexpr std::size_t kMostMessageBytes = 64u << 20;
    const SharedSpan<std::byte> message = readFile(impl_->message.path());
    if (message.size() > kMostMessageBytes)
        throw Error(
            ErrorKind::InvalidContent,
            fmt::format("{}: its loader's report of {} bytes exceeds {}; the file is damaged, or made to "
                        "do harm",
                        impl_->name, message.size(), kMostMessageBytes));
    return {readMesh(impl_->mesh.path(), impl_->name + ": what its loader made of it").mesh,
            std::string(reinterpret_cast<const char*>(message.data()), message.size())};
}

} // namespace rt

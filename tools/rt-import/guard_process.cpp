#include "tools/rt-import/guard_process.h"

#include "common/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace rt {
namespace {

constexpr rlim_t kProcessorSeconds = 120;

void limit(int resource, rlim_t value) {
    rlimit bounds{};
    if (getrlimit(static_cast<__rlimit_resource>(resource), &bounds) != 0) return;
    bounds.rlim_cur = std::min(value, bounds.rlim_max);
    setrlimit(static_cast<__rlimit_resource>(resource), &bounds);
}

void becomeChild(pid_t parent, int errors) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent)
        _exit(static_cast<int>(ErrorKind::Internal)); // the parent died before the line above
    dup2(errors, STDERR_FILENO);
    limit(RLIMIT_CORE, 0);
    limit(RLIMIT_CPU, kProcessorSeconds);
#ifndef __SANITIZE_ADDRESS__ // whose shadow memory takes more address space than any machine has memory
    const long pages = sysconf(_SC_PHYS_PAGES), pageBytes = sysconf(_SC_PAGESIZE);
    if (pages > 0 && pageBytes > 0)
        limit(RLIMIT_AS, static_cast<rlim_t>(pages) / 4 * 3 * static_cast<rlim_t>(pageBytes));
#endif
}

void passOn(int errors) {
    lseek(errors, 0, SEEK_SET);
    std::array<char, 4096> block;
    for (ssize_t got; (got = read(errors, block.data(), block.size())) > 0;)
        std::fwrite(block.data(), 1, static_cast<std::size_t>(got), stderr);
}

} // namespace

std::optional<int> forkGuarded(const std::string& name) {
    const int errors = memfd_create("rt-import", MFD_CLOEXEC);
    const pid_t parent = getpid();
    const pid_t child = errors < 0 ? -1 : fork();
    if (child < 0)
        throw Error(ErrorKind::LimitExceeded,
                    fmt::format("cannot start a process: {}", std::strerror(errno)));
    if (child == 0) {
        becomeChild(parent, errors);
        return std::nullopt;
    }
    int status = 0;
    while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    if (WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU)
        throw Error(
            ErrorKind::LimitExceeded,
            fmt::format("{}: reading it took more than {} s of processor time; it is damaged or too large",
                        name, kProcessorSeconds));
    if (WIFSIGNALED(status))
        throw Error(ErrorKind::InvalidContent, fmt::format("{}: its loader crashed ({}); the file is damaged",
                                                           name, strsignal(WTERMSIG(status))));
    passOn(errors);
    close(errors);
    return WEXITSTATUS(status);
}

} // namespace rt

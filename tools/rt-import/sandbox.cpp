#include "tools/rt-import/sandbox.h"

#include "common/error.h"
#include "common/log.h"

#include <fmt/format.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <linux/landlock.h>
#include <memory>
#include <sched.h>
#include <seccomp.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace rt {
namespace {

// What reading, computing, allocating, threads and the end of a program take.
constexpr std::array kAllowedCalls{SCMP_SYS(read),
                                   SCMP_SYS(readv),
                                   SCMP_SYS(pread64),
                                   SCMP_SYS(write),
                                   SCMP_SYS(writev),
                                   SCMP_SYS(close),
                                   SCMP_SYS(lseek),
                                   SCMP_SYS(fstat),
                                   SCMP_SYS(stat),
                                   SCMP_SYS(lstat),
                                   SCMP_SYS(newfstatat),
                                   SCMP_SYS(statx),
                                   SCMP_SYS(fstatfs),
                                   SCMP_SYS(access),
                                   SCMP_SYS(faccessat),
                                   SCMP_SYS(faccessat2),
                                   SCMP_SYS(readlink),
                                   SCMP_SYS(readlinkat),
                                   SCMP_SYS(getcwd),
                                   SCMP_SYS(getdents64),
                                   SCMP_SYS(fcntl),
                                   SCMP_SYS(ioctl),
                                   SCMP_SYS(fadvise64),
                                   SCMP_SYS(mmap),
                                   SCMP_SYS(munmap),
                                   SCMP_SYS(mremap),
                                   SCMP_SYS(mprotect),
                                   SCMP_SYS(madvise),
                                   SCMP_SYS(brk),
                                   SCMP_SYS(futex),
                                   SCMP_SYS(set_robust_list),
                                   SCMP_SYS(rseq),
                                   SCMP_SYS(sched_yield),
                                   SCMP_SYS(sched_getaffinity),
                                   SCMP_SYS(nanosleep),
                                   SCMP_SYS(clock_nanosleep),
                                   SCMP_SYS(clock_gettime),
                                   SCMP_SYS(clock_getres),
                                   SCMP_SYS(gettimeofday),
                                   SCMP_SYS(time),
                                   SCMP_SYS(rt_sigaction),
                                   SCMP_SYS(rt_sigprocmask),
                                   SCMP_SYS(rt_sigreturn),
                                   SCMP_SYS(sigaltstack),
                                   SCMP_SYS(getpid),
                                   SCMP_SYS(getppid),
                                   SCMP_SYS(gettid),
                                   SCMP_SYS(tgkill),
                                   SCMP_SYS(getuid),
                                   SCMP_SYS(geteuid),
                                   SCMP_SYS(getgid),
                                   SCMP_SYS(getegid),
                                   SCMP_SYS(getrandom),
                                   SCMP_SYS(getrusage),
                                   SCMP_SYS(sysinfo),
                                   SCMP_SYS(uname),
                                   SCMP_SYS(restart_syscall),
                                   SCMP_SYS(exit),
                                   SCMP_SYS(exit_group)};

constexpr scmp_datum_t kWritingFlags = O_ACCMODE | O_CREAT | O_TRUNC | O_APPEND;

class Filter {
public:
    Filter() : context_(seccomp_init(SCMP_ACT_KILL_PROCESS), &seccomp_release) {
        if (!context_) fail(-ENOMEM);
    }

    template <class... Conditions>
    void add(std::uint32_t action, int call, Conditions... conditions) {
        fail(seccomp_rule_add(context_.get(), action, call, sizeof...(conditions), conditions...));
    }
    /// 0, or what keeps the kernel from it, negative.
    int load() { return seccomp_load(context_.get()); }

private:
    static void fail(int status) {
        if (status == -ENOMEM)
            throw Error(ErrorKind::LimitExceeded,
                        "no memory is left for the loader's sandbox; raise --max-memory");
        if (status != 0)
            throw Error(ErrorKind::Internal, fmt::format("the sandbox for the loader cannot be built: {}",
                                                         std::strerror(-status)));
    }

    std::unique_ptr<void, decltype(&seccomp_release)> context_;
};

// Calls of Landlock, for which the C library has no functions.
long landlock(long call, auto... arguments) {
    return syscall(call, arguments...);
}

void allowReading(int ruleset, const std::string& place) {
    const int fd = open(place.c_str(), O_PATH | O_CLOEXEC);
    struct stat info {};
    if (fd >= 0 && fstat(fd, &info) == 0) {
        landlock_path_beneath_attr rule{};
        rule.allowed_access = LANDLOCK_ACCESS_FS_READ_FILE;
        if (S_ISDIR(info.st_mode)) rule.allowed_access |= LANDLOCK_ACCESS_FS_READ_DIR;
        rule.parent_fd = fd;
        landlock(SYS_landlock_add_rule, ruleset, LANDLOCK_RULE_PATH_BENEATH, &rule, 0);
    }
    if (fd >= 0) close(fd); // what is not there cannot be read either
}

// False where the kernel has no Landlock, or it is turned off.
bool confineReading(const std::vector<std::string>& readable) {
    landlock_ruleset_attr handled{};
    handled.handled_access_fs = LANDLOCK_ACCESS_FS_READ_FILE | LANDLOCK_ACCESS_FS_READ_DIR;
    const auto ruleset = static_cast<int>(
        landlock(SYS_landlock_create_ruleset, &handled, sizeof handled.handled_access_fs, 0));
    if (ruleset < 0) return false;
    for (const std::string& place : readable) allowReading(ruleset, place);
    const bool done =
        prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 && landlock(SYS_landlock_restrict_self, ruleset, 0) == 0;
    close(ruleset);
    return done;
}

} // namespace

void enterSandbox(const std::vector<std::string>& readable) {
    if (!confineReading(readable))
        logDetail("this kernel has no Landlock: the loader could read files outside of the model's folders");
    Filter filter;
    for (const int call : kAllowedCalls) filter.add(SCMP_ACT_ALLOW, call);
    filter.add(SCMP_ACT_ALLOW, SCMP_SYS(openat), SCMP_A2(SCMP_CMP_MASKED_EQ, kWritingFlags, O_RDONLY));
    filter.add(SCMP_ACT_ALLOW, SCMP_SYS(open), SCMP_A1(SCMP_CMP_MASKED_EQ, kWritingFlags, O_RDONLY));
    for (const scmp_datum_t flag : {O_WRONLY, O_RDWR, O_CREAT, O_TRUNC, O_APPEND}) {
        filter.add(SCMP_ACT_ERRNO(EACCES), SCMP_SYS(openat), SCMP_A2(SCMP_CMP_MASKED_EQ, flag, flag));
        filter.add(SCMP_ACT_ERRNO(EACCES), SCMP_SYS(open), SCMP_A1(SCMP_CMP_MASKED_EQ, flag, flag));
    }
    // A filter cannot see clone3's flags; told that there is none, the C library calls clone.
    filter.add(SCMP_ACT_ERRNO(ENOSYS), SCMP_SYS(clone3));
    filter.add(SCMP_ACT_ALLOW, SCMP_SYS(clone), SCMP_A0(SCMP_CMP_MASKED_EQ, CLONE_THREAD, CLONE_THREAD));
    // Limits may be asked for, not set.
    filter.add(SCMP_ACT_ALLOW, SCMP_SYS(prlimit64), SCMP_A2(SCMP_CMP_EQ, 0));
    if (const int status = filter.load(); status != 0)
        logWarning(fmt::format("the loader runs without a sandbox, for this kernel has none: {}",
                               std::strerror(-status)));
}

} // namespace rt

// The child that imports: what it may do, how it may end, and what the parent believes of it.
#include "common/error.h"
#include "formats/mesh_file.h"
#include "tests/support/make_mesh.h"
#include "tests/support/temporary_folder.h"
#include "tools/rt-import/guard_process.h"
#include "tools/rt-import/import_message.h"
#include "tools/rt-import/sandbox.h"

#include <gmock/gmock.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <functional>
#include <linux/landlock.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

namespace rt {
namespace {

using testing::HasSubstr;

#ifdef __SANITIZE_ADDRESS__
constexpr bool kSandboxed = false;
#else
constexpr bool kSandboxed = true;
#endif

GuardLimits limits(double seconds = 20.0) {
    return {{std::uint64_t(1) << 30, "the test"}, seconds, {std::filesystem::temp_directory_path()}};
}

// Runs `work` in the child, which ends with what it returns.
std::unique_ptr<GuardProcess> start(const std::function<int(GuardProcess&)>& work,
                                    const GuardLimits& within = limits()) {
    auto guard = std::make_unique<GuardProcess>("m.obj", within);
    if (guard->isChild()) _exit(work(*guard));
    return guard;
}

void expectError(ErrorKind kind, const std::string& reason, const std::function<void()>& work) {
    try {
        work();
        FAIL() << "no error";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), kind) << error.what();
        EXPECT_THAT(error.what(), HasSubstr("m.obj"));
        EXPECT_THAT(error.what(), HasSubstr(reason));
    }
}

TEST(ImportGuard, HandsOverMeshAndMessage) {
    const Mesh sphere = test::makeSphere(2);
    const auto guard = start([&](GuardProcess& child) {
        child.setProgress(0.5);
        child.send(sphere, "message");
        return 0;
    });
    ASSERT_EQ(guard->wait(), 0);
    const ReceivedMesh received = guard->receive();
    EXPECT_EQ(received.message, "message");
    EXPECT_TRUE(std::ranges::equal(received.mesh.positions, sphere.positions));
}

TEST(ImportGuard, ExitCodesComeThrough) {
    EXPECT_EQ(start([](GuardProcess&) { return 4; })->wait(), 4);
}

TEST(ImportGuard, CrashesAreInvalidContent) {
    for (const int signal : {SIGSEGV, SIGABRT, SIGFPE, SIGILL, SIGBUS})
        expectError(ErrorKind::InvalidContent, "crashed", [&] {
            start([&](GuardProcess&) {
                std::signal(signal, SIG_DFL); // the sanitizers have other ideas
                return raise(signal);
            })->wait();
        });
}

TEST(ImportGuard, AChildThatIsKilledFromOutsideIsNotCalledDamaged) {
    for (const auto& [signal, says] :
         {std::pair(SIGKILL, "was stopped from outside (signal 9, Killed); if the "
                             "system ran out of memory"),
          {SIGTERM, "was stopped from outside (signal 15, Terminated)"}})
        expectError(ErrorKind::LimitExceeded, says, [signal = signal] {
            start([signal](GuardProcess&) {
                std::signal(SIGTERM, SIG_DFL);
                return raise(signal);
            })->wait();
        });
}

TEST(ImportGuard, TimeIsLimited) {
    expectError(ErrorKind::LimitExceeded, "0.2 s", [] {
        start(
            [](GuardProcess&) {
                for (volatile bool forever = true; forever;) {
                }
                return 0;
            },
            limits(0.2))
            ->wait();
    });
}

TEST(ImportGuard, AbandonedChildrenEnd) {
    std::array<int, 2> ends{};
    ASSERT_EQ(pipe2(ends.data(), O_CLOEXEC), 0);
    {
        const auto guard = start([&](GuardProcess&) {
            for (volatile bool forever = true; forever;) {
            }
            return 0;
        });
        close(ends[1]);
    }
    char byte = 0;
    EXPECT_EQ(read(ends[0], &byte, 1), 0); // the child's end is closed, as it is gone
    close(ends[0]);
}

TEST(ImportGuard, FloodsAreCut) {
    const auto guard = start([&](GuardProcess& child) {
        const std::string flood(3u << 20, 'x');
        if (write(STDERR_FILENO, flood.data(), flood.size()) < 0) return 1;
        child.send(test::makeSphere(1), std::string(65u << 20, ' '));
        return 0;
    });
    testing::internal::CaptureStderr();
    EXPECT_EQ(guard->wait(), 0);
    EXPECT_EQ(testing::internal::GetCapturedStderr().size(), 1u << 20);
    expectError(ErrorKind::InvalidContent, "exceeds 67108864", [&] { guard->receive(); });
}

TEST(ImportGuard, WhatIsNoMeshIsNotBelieved) {
    const auto guard = start([](GuardProcess&) {
        const std::string junk(1000, 'x');
        return write(STDOUT_FILENO, junk.data(), junk.size()) == 1000 ? 0 : 1;
    });
    ASSERT_EQ(guard->wait(), 0);
    expectError(ErrorKind::InvalidContent, "what its loader made of it", [&] { guard->receive(); });
}

TEST(ImportGuard, AMeshThatLiesIsNotBelieved) {
    Mesh mesh = test::makeSphere(1); // whole and with its checksums right, but an index leads out of it
    std::vector<glm::uvec3> triangles(mesh.triangles.begin(), mesh.triangles.end());
    triangles.back().z = 1u << 30;
    mesh.triangles = std::move(triangles);
    const auto guard = start([&](GuardProcess& child) {
        child.send(mesh, "");
        return 0;
    });
    ASSERT_EQ(guard->wait(), 0);
    expectError(ErrorKind::InvalidContent, "triangle", [&] { guard->receive(); });
}

TEST(ImportGuard, MessagesThatAreNoneAreNotBelieved) {
    const ImportMessage message{std::string("a\n\xff.obj\0b.mtl\0", 14), R"({"triangles":1})"};
    const ImportMessage back = readMessage(toText(message), "m.obj");
    EXPECT_EQ(back.filesAsked, message.filesAsked);
    EXPECT_EQ(back.report, message.report);
    for (const std::string& text : {std::string(), std::string("{}"), std::string("a\0\0[1]", 6),
                                    std::string("\0{", 2), std::string(100'000, '['), std::string("a\0", 2)})
        expectError(ErrorKind::InvalidContent, "no report", [&] { readMessage(text, "m.obj"); });
}

TEST(ImportGuard, MemoryIsLimited) {
    if (!kSandboxed) GTEST_SKIP() << "the sanitizer needs the address space";
    const auto guard = start([](GuardProcess&) {
        void* const much =
            mmap(nullptr, std::size_t(2) << 30, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
        return much == MAP_FAILED ? 5 : 0;
    });
    EXPECT_EQ(guard->wait(), 5);
    GuardLimits few = limits();
    few.memory.bytes = 256 << 20;
    expectError(ErrorKind::LimitExceeded, "--max-memory", [&] { // nor through the file that is handed over
        start(
            [](GuardProcess&) {
                const std::string block(1 << 20, 'x');
                for (int i = 0; i < 300; ++i)
                    if (write(STDOUT_FILENO, block.data(), block.size()) < 0) return 1;
                return 0;
            },
            few)
            ->wait();
    });
}

TEST(ImportGuard, DefaultMemoryGrowsWithTheFile) {
    const std::uint64_t most = defaultMemoryLimit().bytes;
    EXPECT_EQ(readingMemoryLimit(0).bytes, std::min(most, kLeastMemory));
    EXPECT_EQ(readingMemoryLimit(~std::uint64_t(0)).bytes, most);
    const std::uint64_t larger = kLeastMemory / kMemoryPerByte * 2;
    EXPECT_EQ(readingMemoryLimit(larger).bytes, std::min(most, larger * kMemoryPerByte));
}

TEST(ImportGuard, TheSandboxLetsReadAllocateAndStartThreads) {
    const test::TemporaryFolder folder;
    std::ofstream(folder.file("f")) << "text";
    const auto guard = start([&](GuardProcess&) {
        std::string text;
        std::ifstream(folder.file("f")) >> text;
        int sum = 0;
        std::thread([&] {
            sum = static_cast<int>(std::vector<char>(50'000'000, 1).size() / 50'000'000);
        }).join();
        return text == "text" && sum == 1 ? 0 : 1;
    });
    EXPECT_EQ(guard->wait(), 0);
}

TEST(ImportGuard, TheSandboxLetsNothingBeWrittenElsewhere) {
    if (!kSandboxed) GTEST_SKIP() << "there is no sandbox under the sanitizer";
    const test::TemporaryFolder folder;
    std::ofstream(folder.file("f")) << "text";
    for (const int flags : {O_WRONLY, O_RDWR, O_RDONLY | O_TRUNC, O_WRONLY | O_CREAT, O_RDONLY | O_CREAT,
                            O_WRONLY | O_APPEND}) {
        const auto guard = start([&](GuardProcess&) {
            const int fd = open(folder.file(flags & O_CREAT ? "new" : "f").c_str(), flags, 0600);
            return fd < 0 && errno == EACCES ? 0 : 1;
        });
        EXPECT_EQ(guard->wait(), 0) << flags;
    }
    EXPECT_EQ(folder.entryCount(), 1u);
}

TEST(ImportGuard, TheSandboxLetsOnlyWhatIsNamedBeRead) {
    if (!kSandboxed) GTEST_SKIP() << "there is no sandbox under the sanitizer";
    if (syscall(SYS_landlock_create_ruleset, nullptr, 0, LANDLOCK_CREATE_RULESET_VERSION) < 0)
        GTEST_SKIP() << "this kernel has no Landlock";
    const test::TemporaryFolder folder;
    for (const char* name : {"model", "other"}) {
        std::filesystem::create_directory(folder.file(name));
        std::ofstream(folder.file(name) + std::string("/f")) << "text";
    }
    std::ofstream(folder.file("input")) << "text";
    std::filesystem::create_symlink("../other/f", folder.file("model/link"));
    GuardLimits some = limits();
    some.readable = {folder.file("model"), folder.file("input"), folder.file("none")};
    const auto isRead = [&](const std::string& path) {
        return start([&](GuardProcess&) { return open(path.c_str(), O_RDONLY) < 0 ? 1 : 0; }, some)->wait() ==
               0;
    };
    EXPECT_TRUE(isRead(folder.file("model/f")));
    EXPECT_TRUE(isRead(folder.file("input")));
    EXPECT_FALSE(isRead(folder.file("other/f")));
    EXPECT_FALSE(isRead(folder.file("model/link"))) << "leads out";
    EXPECT_FALSE(isRead("/etc/passwd"));
}

TEST(ImportGuard, TheSandboxKillsWhatNoLoaderDoes) {
    if (!kSandboxed) GTEST_SKIP() << "there is no sandbox under the sanitizer";
    const test::TemporaryFolder folder;
    std::ofstream(folder.file("f")) << "text";
    const std::vector<std::function<int()>> deeds{
        [] { return socket(AF_INET, SOCK_STREAM, 0); },
        [] { return socket(AF_UNIX, SOCK_STREAM, 0); },
        [] { return fork() < 0 ? 1 : 0; },
        [] { return execl("/bin/true", "true", nullptr); },
        [&] { return unlink(folder.file("f").c_str()); },
        [&] { return rename(folder.file("f").c_str(), folder.file("g").c_str()); },
        [&] { return mkdir(folder.file("d").c_str(), 0700); },
        [] { return kill(getppid(), SIGTERM); },
        [] {
            const rlimit all{RLIM_INFINITY, RLIM_INFINITY};
            return setrlimit(RLIMIT_AS, &all);
        },
    };
    for (std::size_t i = 0; i < deeds.size(); ++i) {
        SCOPED_TRACE(i);
        expectError(ErrorKind::InvalidContent, "stopped",
                    [&] { start([&](GuardProcess&) { return deeds[i](); })->wait(); });
    }
    EXPECT_EQ(folder.entryCount(), 1u);
}

} // namespace
} // namespace rt

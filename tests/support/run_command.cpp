#include "tests/support/run_command.h"

#include "tests/support/read_text.h"
#include "tests/support/temporary_folder.h"

#include <chrono>
#include <fcntl.h>
#include <fstream>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>

extern char** environ;

namespace rt::test {

CommandResult runCommand(const std::vector<std::string>& argv, const std::string& input) {
    const TemporaryFolder folder;
    std::ofstream(folder.file("in"), std::ios::binary) << input;
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, 0, folder.file("in").c_str(), O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&actions, 1, folder.file("out").c_str(), O_CREAT | O_WRONLY, 0600);
    posix_spawn_file_actions_addopen(&actions, 2, folder.file("err").c_str(), O_CREAT | O_WRONLY, 0600);
    std::vector<char*> arguments;
    for (const std::string& argument : argv) arguments.push_back(const_cast<char*>(argument.c_str()));
    arguments.push_back(nullptr);
    const auto start = std::chrono::steady_clock::now();
    pid_t child = 0;
    const int failed = posix_spawn(&child, argv[0].c_str(), &actions, nullptr, arguments.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    if (failed) throw std::runtime_error("cannot run " + argv[0]);
    int status = 0;
    rusage usage{};
    wait4(child, &status, 0, &usage);
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
    const auto secondsOf = [](const timeval& t) { return double(t.tv_sec) + 1e-6 * double(t.tv_usec); };
    const int exitCode = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    return {exitCode,
            readText(folder.file("out")),
            readText(folder.file("err")),
            elapsed.count(),
            secondsOf(usage.ru_utime) + secondsOf(usage.ru_stime),
            static_cast<std::uint64_t>(usage.ru_maxrss) * 1024u};
}

} // namespace rt::test

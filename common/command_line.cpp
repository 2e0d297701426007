#include "common/command_line.h"

#include "common/binary_io.h"
#include "common/error.h"
#include "common/log.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <set>
#include <string_view>
#include <sys/stat.h>

namespace rt {
namespace {

// Keeps the limit for the rest of the process.
void limitThreads(int threads) {
    static std::unique_ptr<tbb::global_control> limit;
    if (threads > 0)
        limit = std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                                      static_cast<std::size_t>(threads));
}

std::vector<std::string> split(const std::string& text, char separator) {
    std::vector<std::string> parts(1);
    for (char c : text) {
        if (c == separator)
            parts.emplace_back();
        else
            parts.back().push_back(c);
    }
    return parts;
}

// A backslash stands for itself, but for those right before a character that takes one.
std::string escapeForMake(const std::string& path) {
    std::string escaped;
    for (const char c : path) {
        if (std::string_view(" \t#:|").find(c) != std::string_view::npos) {
            const std::size_t name = escaped.find_last_not_of('\\') + 1; // 0 for none
            escaped.append(escaped.size() - name + 1, '\\');
        }
        if (c == '$') escaped += '$';
        escaped += c;
    }
    return escaped;
}

bool sameFile(const std::string& a, const std::string& b) {
    struct stat infoA {
    }, infoB{};
    const bool existsA = stat(a.c_str(), &infoA) == 0;
    const bool existsB = stat(b.c_str(), &infoB) == 0;
    if (existsA && existsB)
        return infoA.st_dev == infoB.st_dev && infoA.st_ino == infoB.st_ino && !S_ISCHR(infoA.st_mode);
    std::error_code failed;                               // an unsearchable folder: the text decides
    const auto canonical = [&](const std::string& path) { // which leaves "x" as it is if there is none
        return std::filesystem::weakly_canonical(std::filesystem::absolute(path), failed);
    };
    const auto pathA = canonical(a);
    const auto pathB = failed ? pathA : canonical(b);
    return failed ? a == b : pathA == pathB;
}

} // namespace

void addCommonOptions(CLI::App& app, CommonOptions& options, const std::string& libraries) {
    app.footer(exitCodeTable());
    app.get_formatter()->column_width(34);
    options.version = fmt::format("{} {}\n{}", app.get_name(), RT_VERSION, libraries);
    app.set_version_flag("--version", options.version);
    app.add_flag("-q,--quiet", options.quiet, "Print errors only");
    app.add_flag("-v,--verbose", options.verbose, "Print details of each stage");
    app.add_option("-j,--threads", options.threads, "Threads to use; 0 = all. Outputs do not depend on it")
        ->check(numberBetween(0, 4096))
        ->type_name("N");
    app.add_option("--json", options.jsonPath, "Write the figures as JSON; - for standard output")
        ->type_name("FILE");
}

void addBuildOptions(CLI::App& app, CommonOptions& options) {
    app.add_option("--depfile", options.depfilePath,
                   "Write a Make/Ninja dependency file: the output, and every file that was read for it")
        ->type_name("FILE");
    app.add_flag("--if-changed", options.ifChanged,
                 "Do nothing if all outputs are there, whole, and made by this version of the same inputs "
                 "with the same options, whatever their time stamps say");
}

std::string makingOf(const CLI::App& app, const CommonOptions& options,
                     const std::vector<std::string>& neutral) {
    std::set<std::string> leftOut{"--help", "--version", "--quiet",   "--verbose",   "--threads",
                                  "--json", "--output",  "--depfile", "--if-changed"};
    leftOut.insert(neutral.begin(), neutral.end());
    std::map<std::string, std::string> given; // in the order of their names
    for (const CLI::Option* option : app.get_options()) {
        const std::string name = option->get_name();
        if (option->count() == 0 || leftOut.contains(name)) continue;
        for (const std::string& value : option->results()) given[name] += '\0' + value;
    }
    std::string making = options.version;
    for (const auto& [name, values] : given) making += '\n' + name + values;
    return making;
}

void checkBuildOptions(const CommonOptions& options, const std::vector<std::string>& inputs,
                       std::vector<std::string> outputs) {
    std::erase(outputs, options.depfilePath);
    if (!options.depfilePath.empty() && (outputs.empty() || outputs.front() == "-"))
        throw Error(ErrorKind::Usage, "--depfile needs an output file to speak of; name one");
    if (!options.ifChanged) return;
    if (outputs.empty()) throw Error(ErrorKind::Usage, "--if-changed needs an output to look at; name one");
    for (const auto& [paths, name] :
         {std::pair(&inputs, "standard input"), std::pair(&std::as_const(outputs), "standard output")})
        if (std::find(paths->begin(), paths->end(), "-") != paths->end())
            throw Error(ErrorKind::Usage,
                        fmt::format("--if-changed needs files to look at; {} is none", name));
}

bool isUpToDate(const CommonOptions& options, std::vector<std::string> outputs,
                const std::function<bool(const std::string& output)>& isMade) {
    std::erase(outputs, options.depfilePath);
    if (!options.ifChanged || !std::ranges::all_of(outputs, isMade)) return false;
    logInfo(fmt::format("up to date: {}", fmt::join(outputs, ", ")));
    return true;
}

CLI::Validator numberBetween(double low, double high) {
    const auto faultOf = [low, high](const std::string& text) -> std::string {
        double value = 0.0;
        if (!CLI::detail::lexical_cast(text, value)) return fmt::format("{} is not a number", text);
        if (value >= low && value <= high) return {};
        return fmt::format("{} is not between {} and {}", text, low, high);
    };
    return {faultOf, fmt::format("in [{} - {}]", low, high)};
}

bool parseCommandLine(CLI::App& app, int argc, const char* const* argv, const CommonOptions& options) {
    for (int i = 1; i < argc; ++i)
        if (argv[i][0] == '\0') throw Error(ErrorKind::Usage, fmt::format("argument {} is empty", i));
    try {
        app.parse(argc, argv);
    } catch (const CLI::Success& request) { // --help and --version come as exceptions from CLI11
        app.exit(request);
        return false;
    } catch (const CLI::ParseError& error) {
        throw Error(ErrorKind::Usage, fmt::format("{}; see {} --help", error.what(), app.get_name()));
    }
    if (options.quiet && options.verbose) throw Error(ErrorKind::Usage, "-q and -v exclude each other");
    setLogLevel(options.quiet ? LogLevel::Quiet : options.verbose ? LogLevel::Verbose : LogLevel::Normal);
    limitThreads(options.threads);
    return true;
}

void requireDistinctPaths(const std::vector<std::string>& inputs, const std::vector<std::string>& outputs) {
    for (std::size_t i = 0; i < outputs.size(); ++i) {
        const std::string& output = outputs[i];
        if (output.empty()) continue;
        for (const std::string& input : inputs)
            if (!input.empty() && input != "-" && output != "-" && sameFile(input, output))
                throw Error(ErrorKind::Usage,
                            fmt::format("{} is an input and an output; name another file to write", output));
        for (std::size_t k = 0; k < i; ++k) {
            const bool bothStandard = outputs[k] == "-" && output == "-";
            const bool oneStandard = outputs[k] == "-" || output == "-";
            if (bothStandard || (!oneStandard && !outputs[k].empty() && sameFile(outputs[k], output)))
                throw Error(ErrorKind::Usage, fmt::format("{} is named for two outputs; name different files",
                                                          bothStandard ? "standard output" : output));
        }
    }
}

std::vector<double> parseNumbers(const std::string& text, std::size_t count, const std::string& option) {
    std::vector<double> numbers;
    for (const std::string& part : split(text, ',')) {
        double value = 0.0;
        const auto [end, status] = std::from_chars(part.data(), part.data() + part.size(), value);
        if (status != std::errc() || end != part.data() + part.size() || !std::isfinite(value))
            throw Error(ErrorKind::Usage, fmt::format("{}: '{}' is not a finite number", option, part));
        numbers.push_back(value);
    }
    if (numbers.size() != count)
        throw Error(ErrorKind::Usage, fmt::format("{}: '{}' has {} numbers; {} separated by commas wanted",
                                                  option, text, numbers.size(), count));
    return numbers;
}

std::vector<unsigned> parseSizes(const std::string& text, std::size_t count, const std::string& option) {
    std::vector<unsigned> sizes;
    for (const std::string& part : split(text, 'x')) {
        unsigned value = 0;
        const auto [end, status] = std::from_chars(part.data(), part.data() + part.size(), value);
        if (status != std::errc() || end != part.data() + part.size() || value == 0)
            throw Error(ErrorKind::Usage,
                        fmt::format("{}: '{}' is not a positive whole number", option, part));
        sizes.push_back(value);
    }
    if (sizes.size() == 1) sizes.assign(count, sizes[0]);
    if (sizes.size() != count)
        throw Error(ErrorKind::Usage,
                    fmt::format("{}: '{}' has {} parts; {} wanted", option, text, sizes.size(), count));
    return sizes;
}

std::uint64_t parseByteSize(const std::string& text, const std::string& option) {
    std::uint64_t value = 0;
    const char* const end = text.data() + text.size();
    const auto [rest, status] = std::from_chars(text.data(), end, value);
    std::string suffix(rest, end);
    std::transform(suffix.begin(), suffix.end(), suffix.begin(),
                   [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
    constexpr std::array<std::string_view, 5> kSuffixes{"", "K", "M", "G", "T"};
    const auto found = std::find(kSuffixes.begin(), kSuffixes.end(), suffix);
    const auto shift = 10 * (found - kSuffixes.begin());
    if (status != std::errc() || value == 0 || found == kSuffixes.end() ||
        value > (~std::uint64_t(0) >> shift))
        throw Error(ErrorKind::Usage,
                    fmt::format("{}: '{}' is not a size; write for example 800M or 12G: bytes, or with K, M, "
                                "G or T multiples of 1024",
                                option, text));
    return value << shift;
}

std::optional<std::string> dependenciesText(const CommonOptions& options,
                                            const std::vector<std::string>& outputs,
                                            const std::vector<std::string>& inputs) {
    if (options.depfilePath.empty()) return std::nullopt;
    std::vector<std::string> files;
    for (const std::string& input : inputs)
        if (!input.empty() && input != "-" && std::find(files.begin(), files.end(), input) == files.end())
            files.push_back(input);
    return depfileText(outputs.front(), files);
}

void writeDependencies(const CommonOptions& options, const std::vector<std::string>& outputs,
                       const std::vector<std::string>& inputs) {
    if (const auto text = dependenciesText(options, outputs, inputs)) writeFile(options.depfilePath, *text);
}

std::string depfileText(const std::string& target, const std::vector<std::string>& inputs) {
    std::string text = escapeForMake(target) + ":";
    for (const std::string& input : inputs) text += " \\\n  " + escapeForMake(input);
    return text + "\n";
}

} // namespace rt

#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace CLI {
class App;
class Validator;
} // namespace CLI

namespace rt {

/// Options that every tool has.
struct CommonOptions {
    int threads = 0; ///< 0 = as many as the machine has
    bool quiet = false;
    bool verbose = false;
    std::string jsonPath;    ///< empty = none, "-" = standard output
    std::string depfilePath; ///< empty = none
    bool ifChanged = false;
    std::string version; ///< what --version prints
    std::string making;  ///< makingOf() the command line, of tools that have --if-changed
};

/// Adds -q, -v, -j/--threads, --json and --version. `libraries` names the libraries and their versions.
void addCommonOptions(CLI::App& app, CommonOptions& options, const std::string& libraries);

/// Adds --depfile and --if-changed, for commands that make files of files.
void addBuildOptions(CLI::App& app, CommonOptions& options);

/// The tool, its version and the options that were given, by name: equal texts and equal inputs make equal
/// outputs. Left out are the common options that change no output, and `neutral`: those, and the ones that
/// name inputs.
std::string makingOf(const CLI::App& app, const CommonOptions& options,
                     const std::vector<std::string>& neutral);

/// Throws Error{Usage} unless --depfile has an output to speak of, and --if-changed files that can be looked
/// at, as the ones that are named have to be.
void checkBuildOptions(const CommonOptions& options, const std::vector<std::string>& inputs,
                       std::vector<std::string> outputs);

/// Whether --if-changed is given and all outputs, but for --depfile's, are there as this run would make them;
/// if so, says so. `isMade`: whether that of this path is.
bool isUpToDate(const CommonOptions& options, std::vector<std::string> outputs,
                const std::function<bool(const std::string& output)>& isMade);

/// For CLI::Option::check(): a number from `low` to `high`, with messages that tell other text from numbers
/// out of range.
CLI::Validator numberBetween(double low, double high);

/// Parses argv. Returns false when --help or --version was asked for and printed.
/// Throws Error{Usage} for anything that does not parse, an empty argument included.
/// Sets the log level and the number of threads from `options`.
bool parseCommandLine(CLI::App& app, int argc, const char* const* argv, const CommonOptions& options);

/// Throws Error{Usage} if an output is one of the inputs or another output. Existing files are the same if
/// they are one file under any name; names of files that do not exist yet are compared as absolute paths.
/// Empty paths stand for no file. "-" as an input is standard input, as an output standard output: only two
/// outputs clash there. Character devices such as /dev/null may be named as often as one likes.
void requireDistinctPaths(const std::vector<std::string>& inputs, const std::vector<std::string>& outputs);

/// Parses "x,y,z" into `count` finite numbers. Throws Error{Usage} naming `option`.
std::vector<double> parseNumbers(const std::string& text, std::size_t count, const std::string& option);

/// Parses "N" or "AxB" or "AxBxC" into positive integers; a single N stands for all `count`.
/// Throws Error{Usage} naming `option`.
std::vector<unsigned> parseSizes(const std::string& text, std::size_t count, const std::string& option);

/// Parses a number of bytes: digits and, for multiples of 1024 to 1024^4, K, M, G or T in either case.
/// Throws Error{Usage} naming `option`.
std::uint64_t parseByteSize(const std::string& text, const std::string& option);

/// What --depfile names: the first output depends on these inputs. Nothing if it was not given.
std::optional<std::string> dependenciesText(const CommonOptions& options,
                                            const std::vector<std::string>& outputs,
                                            const std::vector<std::string>& inputs);
/// Writes dependenciesText(), if it was given.
void writeDependencies(const CommonOptions& options, const std::vector<std::string>& outputs,
                       const std::vector<std::string>& inputs);

/// A dependency file: `target: inputs...`, escaped as GNU make and Ninja both read it. Neither can be given
/// a name with a semicolon or a line break; Ninja 1.11 has no way to write tabs and * ? ' " & | either.
std::string depfileText(const std::string& target, const std::vector<std::string>& inputs);

} // namespace rt

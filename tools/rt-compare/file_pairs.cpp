#include "tools/rt-compare/file_pairs.h"

#include "common/binary_io.h"
#include "common/error.h"
#include "common/log.h"
#include "formats/image.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <set>

namespace rt {
namespace {

namespace fs = std::filesystem;

template <class Key>
std::vector<FilePair> pairUp(const std::map<Key, std::string>& a, const std::map<Key, std::string>& b) {
    std::vector<FilePair> pairs;
    std::set<Key> keys;
    for (const auto& [key, path] : a) keys.insert(key);
    for (const auto& [key, path] : b) keys.insert(key);
    const auto at = [](const std::map<Key, std::string>& files, const Key& key) {
        const auto found = files.find(key);
        return found == files.end() ? std::string() : found->second;
    };
    for (const Key& key : keys) pairs.push_back({at(a, key), at(b, key)});
    return pairs;
}

bool isPicture(const fs::path& path) {
    constexpr std::array kExtensions{".exr", ".png", ".jpg", ".jpeg", ".pfm", ".hdr"};
    return std::ranges::find(kExtensions, extensionOf(path.string())) != kExtensions.end();
}

[[noreturn]] void throwUnreadable(const std::string& folder, const std::error_code& failure) {
    throw Error(ErrorKind::FileAccess,
                fmt::format("{}: cannot read the folder: {}", folder, failure.message()));
}

std::map<std::string, std::string> picturesIn(const std::string& folder) {
    std::map<std::string, std::string> files; // relative name: path
    std::set<std::string> others;
    std::error_code failure, ignored;
    fs::recursive_directory_iterator entry(folder, fs::directory_options::follow_directory_symlink, failure);
    for (; !failure && entry != fs::recursive_directory_iterator(); entry.increment(failure)) {
        const bool isBrokenLink = !entry->exists(ignored); // reading it will say so
        if (!isBrokenLink && !entry->is_regular_file(ignored)) continue;
        if (isPicture(entry->path()))
            files[entry->path().lexically_relative(folder).generic_string()] = entry->path().string();
        else
            others.insert(entry->path().string());
    }
    if (failure) throwUnreadable(folder, failure);
    if (!others.empty())
        logWarning(fmt::format("{}: {} files are not compared, for their names do not end as images' do; the "
                               "first is {}",
                               folder, others.size(), *others.begin()));
    return files;
}

/// `frame.%04d.exr` in parts.
struct Sequence {
    std::string folder, before, after;
    std::size_t digits = 0;

    static std::optional<Sequence> parse(const std::string& path) {
        const fs::path whole(path);
        const std::string name = whole.filename().string();
        const std::size_t percent = name.find('%');
        if (percent == name.npos) return std::nullopt;
        std::size_t end = percent + 1, digits = 0;
        while (end < name.size() && name[end] >= '0' && name[end] <= '9')
            digits = digits * 10 + std::size_t(name[end++] - '0');
        if (end >= name.size() || name[end] != 'd' || digits > 9) return std::nullopt;
        const std::string folder = whole.has_parent_path() ? whole.parent_path().string() : ".";
        return Sequence{folder, name.substr(0, percent), name.substr(end + 1), digits};
    }

    std::optional<std::uint64_t> numberOf(const std::string& name) const {
        if (name.size() < before.size() + after.size() || !name.starts_with(before) || !name.ends_with(after))
            return std::nullopt;
        const std::string middle = name.substr(before.size(), name.size() - before.size() - after.size());
        std::uint64_t number = 0;
        const auto [end, status] = std::from_chars(middle.data(), middle.data() + middle.size(), number);
        if (status != std::errc() || end != middle.data() + middle.size()) return std::nullopt;
        return fmt::format("{:0{}}", number, digits) == middle ? std::optional(number) : std::nullopt;
    }

    std::map<std::uint64_t, std::string> files() const {
        std::map<std::uint64_t, std::string> found;
        std::error_code failure;
        fs::directory_iterator entry(folder, failure);
        for (; !failure && entry != fs::directory_iterator(); entry.increment(failure))
            if (const auto number = numberOf(entry->path().filename().string()))
                found[*number] = entry->path().string();
        if (failure) throwUnreadable(folder, failure);
        return found;
    }
};

std::vector<FilePair> pairUpNumbers(const Sequence& a, const Sequence& b) {
    const auto inA = a.files(), inB = b.files();
    std::set<std::uint64_t> numbers;
    for (const auto& [number, path] : inA) numbers.insert(number);
    for (const auto& [number, path] : inB) numbers.insert(number);
    std::uint64_t missing = 0;
    std::optional<std::uint64_t> first, before;
    for (const std::uint64_t number : numbers) {
        if (before && number > *before + 1) {
            if (missing == 0) first = *before + 1;
            missing += number - *before - 1;
        }
        before = number;
    }
    if (first)
        logWarning(fmt::format("{} numbers between the first and the last have no image in either sequence; "
                               "the first is {}",
                               missing, *first));
    return pairUp(inA, inB);
}

std::vector<FilePair> requireSome(std::vector<FilePair> pairs, const std::string& a, const std::string& b) {
    if (pairs.empty())
        throw Error(ErrorKind::InvalidContent, fmt::format("{} and {}: hold no pictures", a, b));
    return pairs;
}

} // namespace

std::vector<FilePair> findPairs(const std::string& a, const std::string& b) {
    std::error_code ignored; // what is no folder is read as a file, which says what is wrong
    if (fs::is_directory(a, ignored) && fs::is_directory(b, ignored))
        return requireSome(pairUp(picturesIn(a), picturesIn(b)), a, b);
    const std::optional<Sequence> inA = Sequence::parse(a), inB = Sequence::parse(b);
    if (inA && inB && !fs::exists(a, ignored)) return requireSome(pairUpNumbers(*inA, *inB), a, b);
    return {{a, b}};
}

std::vector<FilePair> readPairList(const std::string& path) {
    static constexpr std::uint64_t kMaxBytes = std::uint64_t(64) << 20; // for streams may have no end
    const auto bytes = readFile(path, {0, [](auto) { return std::optional(kMaxBytes); }, std::nullopt});
    const std::string name = inputName(path);
    if (bytes.size() > kMaxBytes)
        throw Error(ErrorKind::LimitExceeded,
                    fmt::format("{}: lists of more than {} MiB are not read", name, kMaxBytes >> 20));
    const std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    std::vector<FilePair> pairs;
    std::size_t number = 0;
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t end = std::min(text.find('\n', at), text.size());
        std::string line = text.substr(at, end - at);
        at = end + 1;
        ++number;
        if (line.ends_with('\r')) line.pop_back();
        if (line.empty() || line.starts_with('#')) continue;
        const char separator = line.find('\t') == line.npos ? ' ' : '\t';
        const std::size_t gap = line.find(separator), rest = line.find_first_not_of(separator, gap);
        if (gap == 0 || gap == line.npos || rest == line.npos || line.find(separator, rest) != line.npos)
            throw Error(ErrorKind::InvalidContent,
                        fmt::format("{}: line {} does not name two files, separated by a tab", name, number));
        pairs.push_back({line.substr(0, gap), line.substr(rest)});
    }
    if (pairs.empty()) throw Error(ErrorKind::InvalidContent, name + ": names no files");
    return pairs;
}

} // namespace rt

#include "tools/rt-import/model_folder.h"

#include "common/json_reader.h"
#include "tools/rt-import/files_asked.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

namespace rt {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostParts = 8; // at the end of a name that are tried

std::string withSlashes(std::string name) {
    std::replace(name.begin(), name.end(), '\\', '/');
    return name;
}

std::string lowerCase(std::string text) {
    for (char& c : text)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return text;
}

// "my tex.png" for "my%20tex.png", as glTF spells its URIs.
std::string percentDecoded(const std::string& name) {
    std::string decoded;
    for (std::size_t i = 0; i < name.size(); ++i) {
        unsigned code = 0;
        const char* digits = name.data() + i + 1;
        const bool escape = name[i] == '%' && i + 2 < name.size() &&
                            std::from_chars(digits, digits + 2, code, 16).ptr == digits + 2;
        decoded += escape ? static_cast<char>(code) : name[i];
        if (escape) i += 2;
    }
    return decoded;
}

// The entry of a folder with this name, or else the first in byte order that differs in letter case only.
std::optional<fs::path> findEntry(const fs::path& folder, const std::string& name) {
    std::error_code ignored;
    if (fs::exists(folder / name, ignored)) return folder / name;
    std::optional<fs::path> found;
    const std::string wanted = lowerCase(name);
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, ignored)) {
        const fs::path candidate = folder / entry.path().filename();
        if (lowerCase(entry.path().filename()) == wanted && (!found || candidate < *found)) found = candidate;
    }
    return found;
}

fs::path orHere(const fs::path& folder) {
    return folder.empty() ? fs::path(".") : folder.lexically_normal();
}

} // namespace

fs::path realPath(const fs::path& path) {
    std::error_code ignored;
    const fs::path real = fs::canonical(path, ignored);
    return real.has_filename() ? real : real.parent_path();
}

bool isBelow(const fs::path& path, const fs::path& folder) {
    return !folder.empty() &&
           std::mismatch(folder.begin(), folder.end(), path.begin(), path.end()).first == folder.end();
}

std::optional<fs::path> findBelow(fs::path folder, const fs::path& relative) {
    for (const fs::path& part : relative) {
        std::optional<fs::path> entry = findEntry(folder, part);
        if (!entry) return std::nullopt;
        folder = std::move(*entry);
    }
    return folder;
}

std::string lowerExtension(const std::string& path) {
    const std::string extension = lowerCase(fs::path(path).extension());
    return extension.empty() ? extension : extension.substr(1);
}

ModelFolder::ModelFolder(const std::string& modelPath, const std::vector<std::string>& others,
                         FilesAsked* asked)
    : modelPath_(modelPath), folders_{orHere(fs::path(modelPath).parent_path())}, asked_(asked) {
    for (const std::string& other : others) folders_.push_back(orHere(other));
    for (const fs::path& folder : folders_) realFolders_.push_back(realPath(folder));
}

bool ModelFolder::isInside(const fs::path& realPath) const {
    return std::any_of(realFolders_.begin(), realFolders_.end(),
                       [&](const fs::path& folder) { return isBelow(realPath, folder); });
}

std::optional<std::string> ModelFolder::find(const std::string& name) const {
    if (auto found = findSpelled(name)) return found;
    const std::string decoded = percentDecoded(name);
    return decoded == name ? std::nullopt : findSpelled(decoded);
}

std::optional<std::string> ModelFolder::findSpelled(const std::string& name) const {
    const fs::path path = fs::path(withSlashes(name)).lexically_normal();
    if (path.is_relative())
        if (auto found = findRelative(path)) return found;
    const std::vector<fs::path> parts(path.begin(), path.end());
    for (std::size_t first = parts.size() - std::min(parts.size(), kMostParts); first < parts.size();
         ++first) {
        fs::path end;
        for (std::size_t i = first; i < parts.size(); ++i) end /= parts[i];
        if (end.is_absolute() || end == path) continue;
        if (auto found = findRelative(end)) return found;
    }
    return std::nullopt;
}

std::optional<std::string> ModelFolder::findRelative(const fs::path& relative) const {
    for (std::size_t i = 0; i < folders_.size(); ++i) {
        // Before anything outside is even looked for.
        const fs::path wanted = (realFolders_[i] / relative).lexically_normal();
        if (!isInside(wanted)) continue;
        if (asked_) asked_->add(wanted);
        const std::optional<fs::path> path = findBelow(folders_[i], relative);
        std::error_code ignored;
        if (!path || !fs::is_regular_file(*path, ignored)) continue;
        const fs::path real = realPath(*path);
        if (!isInside(real)) continue;
        // Where the folder is a link, what ".." leads to is not what stands before it.
        return (*relative.begin() == ".." ? real : path->lexically_normal()).string();
    }
    return std::nullopt;
}

std::optional<std::string> ModelFolder::findComposed(const std::string& path) const {
    if (path == modelPath_) return path;
    const std::string slashed = withSlashes(path);
    const fs::path relative = fs::path(slashed).lexically_normal().lexically_relative(folders_.front());
    return find(relative.empty() ? slashed : relative.string());
}

std::string requireFile(const JsonNode& name, const ModelFolder& folder) {
    const std::string text = name.text();
    const auto found = folder.find(text);
    if (!found)
        name.fail(
            fmt::format("'{}' was not found in the scene file's folder or below, nor in a --texture-root",
                        text),
            ErrorKind::FileAccess);
    return *found;
}

} // namespace rt

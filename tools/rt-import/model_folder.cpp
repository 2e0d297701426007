#include "tools/rt-import/model_folder.h"

#include <algorithm>
#include <charconv>

namespace rt {
namespace {

namespace fs = std::filesystem;

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

std::optional<std::string> findInside(const fs::path& folder, const fs::path& relative) {
    fs::path path = folder;
    for (const fs::path& part : relative) {
        const std::optional<fs::path> entry = findEntry(path, part);
        if (!entry) return std::nullopt;
        path = *entry;
    }
    std::error_code ignored;
    if (!fs::is_regular_file(path, ignored)) return std::nullopt;
    return path.lexically_normal().string();
}

} // namespace

std::string lowerExtension(const std::string& path) {
    const std::string extension = lowerCase(fs::path(path).extension());
    return extension.empty() ? extension : extension.substr(1);
}

ModelFolder::ModelFolder(const std::string& modelPath)
    : modelPath_(modelPath), folder_(fs::path(modelPath).parent_path()) {
    if (folder_.empty()) folder_ = ".";
    folder_ = folder_.lexically_normal();
}

std::optional<std::string> ModelFolder::find(const std::string& name) const {
    if (auto found = findSpelled(name)) return found;
    const std::string decoded = percentDecoded(name);
    return decoded == name ? std::nullopt : findSpelled(decoded);
}

std::optional<std::string> ModelFolder::findSpelled(const std::string& name) const {
    const fs::path path = fs::path(withSlashes(name)).lexically_normal();
    const bool inside = !path.empty() && path.is_relative() && *path.begin() != "..";
    if (inside)
        if (auto found = findInside(folder_, path)) return found;
    const fs::path last = path.filename();
    if (last.empty() || last == "." || last == "..") return std::nullopt;
    return findInside(folder_, last);
}

std::optional<std::string> ModelFolder::findComposed(const std::string& path) const {
    if (path == modelPath_) return path;
    const std::string slashed = withSlashes(path);
    const fs::path relative = fs::path(slashed).lexically_normal().lexically_relative(folder_);
    return find(relative.empty() ? slashed : relative.string());
}

void ModelFolder::addRead(const std::string& path) {
    if (std::find(filesRead_.begin(), filesRead_.end(), path) == filesRead_.end()) filesRead_.push_back(path);
}

} // namespace rt

#include "tools/rt-import/files_asked.h"

#include "formats/recipe.h"
#include "tools/rt-import/model_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

namespace rt {
namespace {

namespace fs = std::filesystem;

const std::string kAbsent(kRecipeIdDigits, '-');

// What stands between the zeros that end each.
std::vector<std::string> recordsOf(const std::string& text) {
    std::vector<std::string> records;
    for (std::size_t at = 0, end = 0; (end = text.find('\0', at)) != text.npos; at = end + 1)
        if (end - at > kRecipeIdDigits) records.push_back(text.substr(at, end - at));
    return records;
}

} // namespace

FilesAsked::FilesAsked(const std::vector<std::string>& inputs, const std::vector<std::string>& roots) {
    const auto add = [&](const fs::path& folder) {
        const fs::path named = folder.empty() ? fs::path(".") : folder;
        folders_.push_back({named, realPath(named)});
    };
    for (const std::string& input : inputs) add(fs::path(input).parent_path());
    for (const std::string& root : roots) add(root);
}

void FilesAsked::add(const fs::path& path) {
    const auto folder = std::find_if(folders_.begin(), folders_.end(),
                                     [&](const Folder& f) { return isBelow(path, f.real); });
    const Place place{static_cast<std::size_t>(folder - folders_.begin()),
                      folder == folders_.end() ? path : path.lexically_relative(folder->real)};
    const auto [entry, isNew] =
        states_.try_emplace(fmt::format("{}/{}", place.folder, place.path.string()), kAbsent);
    if (isNew) entry->second = stateOf(place);
}

std::string FilesAsked::text() const {
    std::string text;
    for (const auto& [name, state] : states_) text += state + name + '\0';
    return text;
}

std::string FilesAsked::again(const std::string& text) const {
    std::string now;
    for (const std::string& record : recordsOf(text)) {
        const std::string name = record.substr(kRecipeIdDigits);
        Place place;
        now += (parse(name, place) ? stateOf(place) : kAbsent) + name + '\0';
    }
    return now;
}

std::vector<std::string> FilesAsked::found(const std::string& text) const {
    std::vector<std::string> paths;
    for (const std::string& record : recordsOf(text)) {
        Place place;
        if (record.starts_with(kAbsent) || !parse(record.substr(kRecipeIdDigits), place)) continue;
        const auto file = findBelow(folders_[place.folder].real, place.path);
        if (file) paths.push_back(namedPath(place, *file)); // or it has gone since
    }
    return paths;
}

std::vector<std::string> FilesAsked::foldersOfMissing(const std::string& text) const {
    std::vector<std::string> paths;
    for (const std::string& record : recordsOf(text)) {
        Place place;
        if (!record.starts_with(kAbsent) || !parse(record.substr(kRecipeIdDigits), place)) continue;
        std::optional<fs::path> folder;
        for (fs::path way = place.path; !folder;) {
            way = way.parent_path();
            folder = findBelow(folders_[place.folder].real, way);
        }
        if (isInside(realPath(*folder))) paths.push_back(namedPath(place, *folder));
    }
    return paths;
}

std::string FilesAsked::namedPath(const Place& place, const fs::path& found) const {
    const fs::path relative = found.lexically_relative(folders_[place.folder].real);
    const fs::path path = (folders_[place.folder].named / relative).lexically_normal();
    return (path.has_filename() ? path : path.parent_path()).string(); // no slash at the end
}

bool FilesAsked::isInside(const fs::path& real) const {
    return std::any_of(folders_.begin(), folders_.end(),
                       [&](const Folder& folder) { return isBelow(real, folder.real); });
}

std::string FilesAsked::stateOf(const Place& place) const {
    if (place.folder >= folders_.size()) return kAbsent;
    const auto file = findBelow(folders_[place.folder].real, place.path);
    if (!file) return kAbsent;
    const fs::path real = realPath(*file);
    return isInside(real) ? contentIdOf(real.string()).value_or(kAbsent) : kAbsent;
}

bool FilesAsked::parse(const std::string& name, Place& place) const {
    const char* const end = name.data() + name.size();
    const auto [rest, fault] = std::from_chars(name.data(), end, place.folder);
    if (fault != std::errc() || rest == end || *rest != '/' || place.folder >= folders_.size()) return false;
    place.path = fs::path(std::string(rest + 1, end));
    return true;
}

} // namespace rt

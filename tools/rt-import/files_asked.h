#pragma once
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace rt {

/// The files that an import looked for besides its inputs, found or not, and what they held: where all of
/// them are the same again, another import makes the same. Each is named by the number of the folder that it
/// is in or below, those of the inputs first, then those of --texture-root, and its path from there.
class FilesAsked {
public:
    FilesAsked(const std::vector<std::string>& inputs, const std::vector<std::string>& roots);

    /// A path below a folder, which has all links followed. To be called before the file is read.
    void add(const std::filesystem::path& realPath);

    /// One after the other: kRecipeIdDigits of contentIdOf(), or dashes where there is no such file; number
    /// of the folder, '/', path, 0.
    std::string text() const;

    /// The text that the same files give now. Does not believe what it is given.
    std::string again(const std::string& text) const;

    /// Paths of those that were found, by the names that the folders have on the command line.
    std::vector<std::string> found(const std::string& text) const;

    /// For each of those that were not found, the deepest folder on the way to it that is there: it changes
    /// when what is missing appears.
    std::vector<std::string> foldersOfMissing(const std::string& text) const;

private:
    struct Folder {
        std::filesystem::path named, real;
    };
    struct Place {
        std::size_t folder = 0;
        std::filesystem::path path;
    };
    std::string stateOf(const Place& place) const;
    bool parse(const std::string& name, Place& place) const;
    bool isInside(const std::filesystem::path& real) const;
    std::string namedPath(const Place& place, const std::filesystem::path& found) const;

    std::vector<Folder> folders_;
    std::map<std::string, std::string> states_; // by folder and path
};

} // namespace rt

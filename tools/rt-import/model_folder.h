#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace rt {

class FilesAsked;
class JsonNode;

/// "obj" for "a/B.OBJ"; empty if there is none.
std::string lowerExtension(const std::string& path);

/// As it is on disk, all links followed, no slash at the end; empty if there is no such thing.
std::filesystem::path realPath(const std::filesystem::path& path);
/// Whether it is the folder or in it, by their names.
bool isBelow(const std::filesystem::path& path, const std::filesystem::path& folder);
/// The file or folder at the end of the relative path, letter case ignored where none matches exactly.
std::optional<std::filesystem::path> findBelow(std::filesystem::path folder,
                                               const std::filesystem::path& relative);

/// The folder that a model or scene file lies in, and others that it may read from. Names that its text gives
/// to other files are looked up here and nowhere else.
class ModelFolder {
public:
    /// `asked` is told every file that is looked for.
    explicit ModelFolder(const std::string& modelPath, const std::vector<std::string>& others = {},
                         FilesAsked* asked = nullptr);

    const std::string& modelPath() const { return modelPath_; }

    /// Path of the file that `name`, as the model spells it, stands for, in one of the folders or below.
    /// Backslashes count as slashes, and letter case is ignored where no file matches exactly. A name that
    /// leads to nothing there, as one that is absolute on another machine, is tried by what stands at its
    /// end: the last eight parts of it, the last seven, and so on to the last one. %20 and the like are
    /// decoded if nothing is found otherwise. A link is followed if it stays within the folders. Empty if no
    /// file matches.
    std::optional<std::string> find(const std::string& name) const;

    /// As find(), for a path that a library composed from the model's own path and a name.
    std::optional<std::string> findComposed(const std::string& path) const;

private:
    std::optional<std::string> findSpelled(const std::string& name) const;
    std::optional<std::string> findRelative(const std::filesystem::path& relative) const;
    bool isInside(const std::filesystem::path& realPath) const;

    std::string modelPath_;
    std::vector<std::filesystem::path> folders_; // the model's own first
    std::vector<std::filesystem::path> realFolders_;
    FilesAsked* asked_;
};

/// The file that a text of a scene file names. Throws Error{FileAccess} if there is none.
std::string requireFile(const JsonNode& name, const ModelFolder& folder);

} // namespace rt

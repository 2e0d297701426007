#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace rt {

/// "obj" for "a/B.OBJ"; empty if there is none.
std::string lowerExtension(const std::string& path);

/// The folder that a model lies in. Names that the model's text gives to other files are looked up here and
/// nowhere else, and every file that is read is remembered for the dependency file.
class ModelFolder {
public:
    explicit ModelFolder(const std::string& modelPath);

    /// Path of the file that `name`, as the model spells it, stands for: backslashes count as slashes, letter
    /// case is ignored where no file matches exactly, and a name that leads out of the folder or to nothing
    /// is tried by its last part. %20 and the like are decoded if nothing is found otherwise. Empty if no
    /// file matches.
    std::optional<std::string> find(const std::string& name) const;

    /// As find(), for a path that a library composed from the model's own path and a name.
    std::optional<std::string> findComposed(const std::string& path) const;

    /// Remembers a file that was read, once.
    void addRead(const std::string& path);
    /// Files read, the model among them, in the order of their first reading.
    const std::vector<std::string>& filesRead() const { return filesRead_; }

private:
    std::optional<std::string> findSpelled(const std::string& name) const;

    std::string modelPath_;
    std::filesystem::path folder_;
    std::vector<std::string> filesRead_;
};

} // namespace rt

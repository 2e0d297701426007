#include "tools/rt-import/open_model.h"

#include "common/binary_io.h"
#include "common/error.h"
#include "tools/rt-import/model_folder.h"

#include <assimp/BaseImporter.h>
#include <assimp/DefaultIOSystem.h>
#include <assimp/Importer.hpp>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <assimp/version.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <optional>
#include <set>
#include <string_view>

namespace rt {
namespace {

namespace fs = std::filesystem;

// The loaders that are used. Assimp has some forty more, most of them rarely tried on hostile input.
constexpr std::array<std::string_view, 6> kExtensions{"obj", "ply", "stl", "gltf", "glb", "3ds"};

void requireReadable(const std::string& path) {
    std::error_code ignored;
    const fs::file_status status = fs::status(path, ignored);
    if (fs::exists(status) && !fs::is_regular_file(status) && !fs::is_directory(status))
        throw Error(ErrorKind::FileAccess, path + ": is not a regular file; models are read from files only");
    const bool empty = readFile(path).empty();
    const std::string extension = lowerExtension(path);
    if (std::find(kExtensions.begin(), kExtensions.end(), extension) == kExtensions.end())
        throw Error(ErrorKind::InvalidContent,
                    fmt::format("{}: extension '{}' is not among those that are read: {}", path, extension,
                                readableFormats()));
    if (empty) throw Error(ErrorKind::InvalidContent, path + ": is empty; a model was expected");
}

// Opens only what lies in the model's folder, for reading, and keeps the list of what it opened.
class FolderIO final : public Assimp::DefaultIOSystem {
public:
    explicit FolderIO(ModelFolder& folder) : folder_(folder) {}

    bool Exists(const char* file) const override { return found(file).has_value(); }

    Assimp::IOStream* Open(const char* file, const char* mode) override {
        const std::optional<std::string> path = mode[0] == 'r' ? found(file) : std::nullopt;
        Assimp::IOStream* stream = path ? DefaultIOSystem::Open(path->c_str(), mode) : nullptr;
        if (stream) folder_.addRead(*path);
        return stream;
    }

    const std::string& firstMissing() const { return firstMissing_; }

private:
    std::optional<std::string> found(const char* file) const {
        std::optional<std::string> path = folder_.findComposed(file);
        if (!path && firstMissing_.empty()) firstMissing_ = fs::path(file).filename().string();
        return path;
    }

    ModelFolder& folder_;
    mutable std::string firstMissing_; // Exists() is const to Assimp
};

// Leaves only the loaders of this extension, so that no other one gets to guess at a damaged file.
void keepLoadersOf(const std::string& extension, Assimp::Importer& importer) {
    for (std::size_t i = importer.GetImporterCount(); i-- > 0;) {
        Assimp::BaseImporter* loader = importer.GetImporter(i);
        std::set<std::string> extensions;
        loader->GetExtensionList(extensions);
        if (extensions.contains(extension)) continue;
        importer.UnregisterLoader(loader);
        delete loader; // unregistering hands it over
    }
}

} // namespace

struct OpenModel::Impl {
    Assimp::Importer importer;
    const aiScene* scene = nullptr;
};

OpenModel::OpenModel(const std::string& path, ModelFolder& folder, std::vector<std::string>& warnings)
    : impl_(std::make_unique<Impl>()) {
    requireReadable(path);
    auto* io = new FolderIO(folder);
    impl_->importer.SetIOHandler(io); // which owns it from here on
    keepLoadersOf(lowerExtension(path), impl_->importer);
    impl_->scene = impl_->importer.ReadFile(path, aiProcess_Triangulate);
    if (!impl_->scene || !impl_->scene->mRootNode)
        throw Error(ErrorKind::InvalidContent,
                    fmt::format("{}: cannot be read as a model: {}", path, impl_->importer.GetErrorString()));
    if (!io->firstMissing().empty())
        warnings.push_back(
            fmt::format("file '{}', which the model names, was not found in its folder", io->firstMissing()));
}

OpenModel::~OpenModel() = default;

const aiScene& OpenModel::scene() const {
    return *impl_->scene;
}

std::string readableFormats() {
    return fmt::format("{}", fmt::join(kExtensions, ", "));
}

std::string assimpVersion() {
    return fmt::format("Assimp {}.{}.{}", aiGetVersionMajor(), aiGetVersionMinor(), aiGetVersionPatch());
}

} // namespace rt

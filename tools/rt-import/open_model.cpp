#include "tools/rt-import/open_model.h"

#include "common/binary_io.h"
#include "common/error.h"
#include "tools/rt-import/check_collada.h"
#include "tools/rt-import/check_ply.h"
#include "tools/rt-import/correct_3ds.h"
#include "tools/rt-import/cut_polygons.h"
#include "tools/rt-import/import_model.h"
#include "tools/rt-import/mend_mtl.h"
#include "tools/rt-import/model_folder.h"
#include "tools/rt-import/model_formats.h"

#include <assimp/BaseImporter.h>
#include <assimp/DefaultIOSystem.h>
#include <assimp/Importer.hpp>
#include <assimp/MemoryIOWrapper.h>
#include <assimp/ProgressHandler.hpp>
#include <assimp/material.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <assimp/version.h>
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <set>
#include <span>

namespace rt {
namespace {

namespace fs = std::filesystem;

void requireReadable(const std::string& path, const std::vector<std::string>& allowedFormats) {
    std::error_code ignored;
    const fs::file_status status = fs::status(path, ignored);
    if (fs::exists(status) && !fs::is_regular_file(status) && !fs::is_directory(status))
        throw Error(ErrorKind::FileAccess, path + ": is not a regular file; models are read from files only");
    const SharedSpan<std::byte> bytes = readFile(path);
    const std::string extension = lowerExtension(path);
    if (!isReadable(extension, allowedFormats))
        throw Error(
            ErrorKind::InvalidContent,
            fmt::format("{}: extension '{}' is not among those that are read ({}); --allow-format may "
                        "add it, --list-formats lists all",
                        path, extension, readableFormats()));
    if (bytes.empty()) throw Error(ErrorKind::InvalidContent, path + ": is empty; a model was expected");
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    if (extension == "dae") checkCollada(text, path);
    if (extension == "ply") checkPly(text, path);
}

// Opens only what lies in the model's folder, for reading.
class FolderIO final : public Assimp::DefaultIOSystem {
public:
    FolderIO(const ModelFolder& folder, std::vector<std::string>& warnings)
        : folder_(folder), warnings_(warnings) {}

    bool Exists(const char* file) const override { return found(file).has_value(); }

    Assimp::IOStream* Open(const char* file, const char* mode) override {
        const std::optional<std::string> path = mode[0] == 'r' ? found(file) : std::nullopt;
        Assimp::IOStream* stream = path ? DefaultIOSystem::Open(path->c_str(), mode) : nullptr;
        if (!stream) return nullptr;
        if (lowerExtension(folder_.modelPath()) != "obj" || *path == folder_.modelPath()) return stream;
        Close(stream);
        return openLibrary(*path);
    }

    const std::string& firstMissing() const { return firstMissing_; }
    /// Names that the material libraries of an OBJ model give.
    const std::set<std::string>& definedMaterials() const { return definedMaterials_; }

private:
    Assimp::IOStream* openLibrary(const std::string& path) {
        const SharedSpan<std::byte> bytes = readFile(path);
        const std::string text = mendMtl({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, path,
                                         definedMaterials_, warnings_);
        auto* copy = new std::uint8_t[text.size()];
        std::copy(text.begin(), text.end(), copy);
        return new Assimp::MemoryIOStream(copy, text.size(), true);
    }

    std::optional<std::string> found(const char* file) const {
        std::optional<std::string> path = folder_.findComposed(file);
        if (!path && firstMissing_.empty()) firstMissing_ = fs::path(file).filename().string();
        return path;
    }

    const ModelFolder& folder_;
    std::vector<std::string>& warnings_;
    std::set<std::string> definedMaterials_;
    mutable std::string firstMissing_; // Exists() is const to Assimp
};

// Assimp makes up the materials of an OBJ model that no library defines.
void warnOfUndefined(const aiScene& scene, const std::set<std::string>& defined,
                     std::vector<std::string>& warnings) {
    constexpr std::size_t kMostNames = 5;
    std::vector<std::string> names;
    std::vector<bool> used(scene.mNumMaterials);
    for (const aiMesh* mesh : std::span(scene.mMeshes, scene.mNumMeshes))
        if (mesh->mMaterialIndex < used.size()) used[mesh->mMaterialIndex] = true;
    for (unsigned m = 0; m < scene.mNumMaterials; ++m) {
        const std::string name = scene.mMaterials[m]->GetName().C_Str();
        if (used[m] && name != AI_DEFAULT_MATERIAL_NAME && !defined.contains(name)) names.push_back(name);
    }
    if (names.empty()) return;
    const std::size_t shown = std::min(names.size(), kMostNames);
    warnings.push_back(fmt::format(
        "no material library defines '{}'{}; what they are on is grey",
        fmt::join(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(shown), "', '"),
        names.size() > shown ? fmt::format(" and {} more of its materials", names.size() - shown) : ""));
}

class LoaderProgress final : public Assimp::ProgressHandler {
public:
    explicit LoaderProgress(std::function<void(double)> progress) : progress_(std::move(progress)) {}
    bool Update(float part) override {
        if (part >= 0.0f) progress_(static_cast<double>(part));
        return true;
    }

private:
    std::function<void(double)> progress_;
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
    std::vector<CutPolygons> polygons; // of each mesh
};

OpenModel::OpenModel(const std::string& path, const ImportSettings& settings, const ModelFolder& folder,
                     std::vector<std::string>& warnings)
    : impl_(std::make_unique<Impl>()) {
    requireReadable(path, settings.allowedFormats);
    Assimp::Importer& importer = impl_->importer;
    auto* io = new FolderIO(folder, warnings);
    importer.SetIOHandler(io); // which owns it from here on, and the next one too
    importer.SetProgressHandler(new LoaderProgress(settings.progress));
    keepLoadersOf(lowerExtension(path), importer);
    const auto requireScene = [&] {
        if (impl_->scene && impl_->scene->mRootNode) return;
        const std::string reason = importer.GetErrorString();
        if (reason.find("bad_alloc") != std::string::npos)
            throw Error(ErrorKind::LimitExceeded,
                        path +
                            ": memory does not suffice to read it; it is damaged or --max-memory is too low");
        throw Error(ErrorKind::InvalidContent,
                    fmt::format("{}: cannot be read as a model: {}", path, reason));
    };
    impl_->scene = importer.ReadFile(path, 0);
    requireScene();
    // The importer owns the scene and hands it out for reading only, but made it to be processed further.
    auto& unfinished = const_cast<aiScene&>(*impl_->scene);
    if (lowerExtension(path) == "3ds") correct3ds(readFile(path), !settings.repair.creaseDegrees, unfinished);
    impl_->polygons = listPolygons(unfinished);
    impl_->scene = importer.ApplyPostProcessing(aiProcess_Triangulate);
    requireScene();
    matchTriangles(*impl_->scene, impl_->polygons);
    if (lowerExtension(path) == "obj") warnOfUndefined(*impl_->scene, io->definedMaterials(), warnings);
    if (!io->firstMissing().empty())
        warnings.push_back(
            fmt::format("file '{}', which the model names, was not found in its folder", io->firstMissing()));
}

OpenModel::~OpenModel() = default;

const aiScene& OpenModel::scene() const {
    return *impl_->scene;
}

const std::vector<std::uint32_t>& OpenModel::polygonsOf(unsigned mesh) const {
    return impl_->polygons[mesh].ofTriangle;
}

const std::vector<std::uint32_t>& OpenModel::badPolygonsOf(unsigned mesh) const {
    return impl_->polygons[mesh].bad;
}

std::string assimpVersion() {
    return fmt::format("Assimp {}.{}.{}", aiGetVersionMajor(), aiGetVersionMinor(), aiGetVersionPatch());
}

} // namespace rt

#include "tools/rt-import/model_formats.h"

#include "common/error.h"

#include <assimp/BaseImporter.h>
#include <assimp/Importer.hpp>
#include <assimp/importerdesc.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <string_view>

namespace rt {
namespace {

// The loaders that are used. Assimp has some forty more, most of them rarely tried on hostile input.
constexpr std::array<std::string_view, 9> kExtensions{"obj", "ply", "stl", "gltf", "glb",
                                                      "fbx", "3ds", "dae", "off"};

bool isListed(std::string_view extension) {
    return std::find(kExtensions.begin(), kExtensions.end(), extension) != kExtensions.end();
}

// Names of the loaders by extension.
std::map<std::string, std::string> loadersByExtension() {
    Assimp::Importer importer;
    std::map<std::string, std::string> loaders;
    for (std::size_t i = 0; i < importer.GetImporterCount(); ++i) {
        std::set<std::string> extensions;
        importer.GetImporter(i)->GetExtensionList(extensions);
        for (const std::string& extension : extensions)
            loaders.try_emplace(extension, importer.GetImporterInfo(i)->mName);
    }
    return loaders;
}

} // namespace

std::string readableFormats() {
    return fmt::format("{}", fmt::join(kExtensions, ", "));
}

bool isReadable(const std::string& extension, const std::vector<std::string>& allowed) {
    return isListed(extension) || std::find(allowed.begin(), allowed.end(), extension) != allowed.end();
}

void requireKnownFormat(const std::string& extension) {
    if (!loadersByExtension().contains(extension))
        throw Error(ErrorKind::Usage,
                    fmt::format("--allow-format: '{}' is not an extension that any loader reads; "
                                "--list-formats lists them",
                                extension));
}

std::string formatTable() {
    const std::map<std::string, std::string> loaders = loadersByExtension();
    std::string table;
    for (const std::string_view extension : kExtensions)
        table += fmt::format("{:<10} {:<16} {}\n", extension, "read", loaders.at(std::string(extension)));
    for (const auto& [extension, name] : loaders)
        if (!isListed(extension))
            table += fmt::format("{:<10} {:<16} {}\n", extension, "--allow-format", name);
    return table;
}

} // namespace rt

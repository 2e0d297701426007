#include "tools/rt-import/read_gltf_extras.h"

#include "common/binary_io.h"
#include "tools/rt-import/model_folder.h"

#include <assimp/scene.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <optional>
#include <string_view>

namespace rt {
namespace {

using nlohmann::json;

// Read by Assimp or here.
constexpr std::array<std::string_view, 13> kKnownExtensions{
    "KHR_draco_mesh_compression", "KHR_lights_punctual",
    "KHR_materials_clearcoat",    "KHR_materials_emissive_strength",
    "KHR_materials_ior",          "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_sheen",        "KHR_materials_specular",
    "KHR_materials_transmission", "KHR_materials_unlit",
    "KHR_materials_volume",       "KHR_mesh_quantization",
    "KHR_texture_transform"};

// A member, or null for what is absent or has no members.
const json& member(const json& object, const char* key) {
    static const json kNothing;
    if (!object.is_object()) return kNothing;
    const auto found = object.find(key);
    return found == object.end() ? kNothing : *found;
}

const json& element(const json& array, std::size_t index) {
    static const json kNothing;
    return array.is_array() && index < array.size() ? array[index] : kNothing;
}

std::optional<std::size_t> indexOf(const json& value) {
    return value.is_number_unsigned() ? std::optional(value.get<std::size_t>()) : std::nullopt;
}

float numberOr(const json& value, float fallback) {
    const float number = value.is_number() ? value.get<float>() : fallback;
    return std::isfinite(number) ? number : fallback;
}

// The first chunk of a .glb, which holds the text. Assimp has read the file before, so that it is sound.
std::string_view jsonText(std::span<const std::byte> bytes, bool binary) {
    const std::string_view all(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    constexpr std::size_t kHeader = 12, kChunkHeader = 8;
    if (!binary) return all;
    if (all.size() < kHeader + kChunkHeader) return {};
    std::uint32_t length = 0;
    std::memcpy(&length, all.data() + kHeader, sizeof(length));
    return all.substr(kHeader + kChunkHeader, length);
}

// Null if it is damaged. What may be large is left out.
json parse(std::string_view text) {
    const auto keep = [](int, json::parse_event_t event, json& parsed) {
        return event != json::parse_event_t::key ||
               (parsed != "buffers" && parsed != "bufferViews" && parsed != "accessors" &&
                parsed != "images" && parsed != "animations");
    };
    json document = json::parse(text.begin(), text.end(), keep, false);
    return document.is_discarded() ? json() : document;
}

std::optional<GltfMaterialExtras> extrasOf(const json& material) {
    const json& extensions = member(material, "extensions");
    const json& strength = member(extensions, "KHR_materials_emissive_strength");
    const json& specular = member(extensions, "KHR_materials_specular");
    if (strength.is_null() && specular.is_null()) return std::nullopt;
    GltfMaterialExtras extras;
    extras.emissiveStrength = std::max(0.0f, numberOr(member(strength, "emissiveStrength"), 1.0f));
    extras.specular = std::clamp(numberOr(member(specular, "specularFactor"), 1.0f), 0.0f, 1.0f);
    if (!member(specular, "specularTexture").is_null()) extras.lost.emplace_back("specular texture");
    if (!member(specular, "specularColorFactor").is_null() ||
        !member(specular, "specularColorTexture").is_null())
        extras.lost.emplace_back("specular colour");
    return extras;
}

// Goes through the nodes of the file and of the scene side by side: Assimp numbers materials, lights and
// cameras anew, by its order of reading.
class NodePairs {
public:
    NodePairs(const json& document, const aiScene& scene)
        : document_(document), nodes_(member(document, "nodes")), scene_(scene) {}

    GltfExtras read() {
        const auto sceneIndex = indexOf(member(document_, "scene")).value_or(0);
        const json& roots = member(element(member(document_, "scenes"), sceneIndex), "nodes");
        if (roots.size() == 1)
            push(roots[0], scene_.mRootNode);
        else // Assimp puts a node of its own above several
            pushChildren(roots, scene_.mRootNode);
        while (!stack_.empty()) {
            const auto [node, ainode] = stack_.back();
            stack_.pop_back();
            visit(*node, ainode);
            pushChildren(member(*node, "children"), ainode);
        }
        for (const auto& [light, nodes] : lights_) addNames(nodes, extras_.lightNodes);
        for (const auto& [camera, nodes] : cameras_) addNames(nodes, extras_.cameraNodes);
        return std::move(extras_);
    }

private:
    using Users = std::map<std::size_t, std::vector<const aiNode*>>;

    void push(const json& index, const aiNode* ainode) {
        const auto i = indexOf(index);
        const json& node = i ? element(nodes_, *i) : element(nodes_, nodes_.size());
        if (node.is_object()) stack_.emplace_back(&node, ainode);
    }

    // Last first, so that the first is popped first.
    void pushChildren(const json& children, const aiNode* parent) {
        if (!children.is_array() || children.size() != parent->mNumChildren) return;
        for (std::size_t i = children.size(); i-- > 0;) push(children[i], parent->mChildren[i]);
    }

    void visit(const json& node, const aiNode* ainode) {
        const json& light = member(member(member(node, "extensions"), "KHR_lights_punctual"), "light");
        if (const auto i = indexOf(light)) lights_[*i].push_back(ainode);
        if (const auto i = indexOf(member(node, "camera"))) cameras_[*i].push_back(ainode);
        const auto mesh = indexOf(member(node, "mesh"));
        if (!mesh) return;
        const json& primitives = member(element(member(document_, "meshes"), *mesh), "primitives");
        if (!primitives.is_array() || primitives.size() != ainode->mNumMeshes) return;
        for (std::size_t i = 0; i < primitives.size(); ++i)
            addMaterial(member(primitives[i], "material"),
                        scene_.mMeshes[ainode->mMeshes[i]]->mMaterialIndex);
    }

    void addMaterial(const json& index, unsigned sceneIndex) {
        const auto i = indexOf(index);
        const json& material = i ? element(member(document_, "materials"), *i) : index;
        if (auto extras = extrasOf(material)) extras_.materials.try_emplace(sceneIndex, std::move(*extras));
    }

    static void addNames(const std::vector<const aiNode*>& nodes, NodesByName& byName) {
        for (const aiNode* node : nodes) byName.try_emplace(node->mName.C_Str(), nodes);
    }

    const json& document_;
    const json& nodes_;
    const aiScene& scene_;
    std::vector<std::pair<const json*, const aiNode*>> stack_;
    Users lights_, cameras_; // by the file's numbers
    GltfExtras extras_;
};

} // namespace

GltfExtras readGltfExtras(const std::string& path, const aiScene& scene, std::vector<std::string>& warnings) {
    const std::string extension = lowerExtension(path);
    if (extension != "gltf" && extension != "glb") return {};
    const auto bytes = readFile(path);
    const json document = parse(jsonText(bytes, extension == "glb"));
    for (const json& used : member(document, "extensionsUsed")) {
        if (!used.is_string()) continue;
        const auto& name = used.get_ref<const std::string&>();
        if (std::find(kKnownExtensions.begin(), kKnownExtensions.end(), name) == kKnownExtensions.end())
            warnings.push_back(fmt::format("its extension {} is not carried over", name));
    }
    return NodePairs(document, scene).read();
}

} // namespace rt

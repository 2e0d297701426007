#include "tools/rt-import/scene_description.h"

#include "common/error.h"
#include "common/json_reader.h"
#include "tools/rt-import/describe_scenery.h"
#include "tools/rt-import/model_folder.h"
#include "tools/rt-import/place_scenery.h"

#include <fmt/format.h>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <optional>

namespace rt {
namespace {

constexpr unsigned kMaxSceneDepth = 8;                   // scene files that name each other
constexpr std::size_t kMaxPlaced = std::size_t(1) << 20; // models, lights and cameras, instances counted each

/// Lengths and directions of a file's coordinates.
struct Space {
    double metres = 1.0;
    UpAxis up = UpAxis::Y;
};

// glTF and COLLADA say it themselves, or Assimp makes it so; nothing is known of the others.
std::optional<Space> spaceOfFormat(const std::string& path) {
    const std::string extension = lowerExtension(path);
    const bool known = extension == "gltf" || extension == "glb" || extension == "dae";
    return known ? std::optional<Space>(Space{}) : std::nullopt;
}

glm::dmat4 change(const Space& from, const Space& to) {
    const glm::dmat4 turn = glm::inverse(yUpFrom(to.up)) * yUpFrom(from.up);
    return glm::scale(turn, glm::dvec3(from.metres / to.metres));
}

Space readSpace(const JsonNode& json, Space space) {
    if (const auto units = json.find("units")) space.metres = readUnit(*units);
    if (const auto up = json.find("upAxis")) space.up = readUpAxis(*up);
    return space;
}

// What an entry of "models" hands down to what it names.
struct Entry {
    std::vector<glm::dmat4> placements; // world from the scene that the entry stands in, transforms included
    Space space;                        // of that scene
    std::vector<std::uint32_t> overrides; // of that scene and those round it, inner ones first
    bool lights = true, cameras = true;
};

// Instances of a model that have the same overrides.
struct Instances {
    std::vector<glm::dmat4> transforms;
    std::vector<std::uint32_t> overrides;
};

std::vector<std::uint32_t> joined(std::initializer_list<std::vector<std::uint32_t>> lists) {
    std::vector<std::uint32_t> all;
    for (const auto& list : lists) all.insert(all.end(), list.begin(), list.end());
    return all;
}

class Describer {
public:
    Describer(const std::vector<std::string>& roots, FilesAsked* asked) : roots_(roots), asked_(asked) {}

    SceneDescription result;

    void addInput(const std::string& path, const Space& world) {
        Entry entry;
        entry.placements = {glm::dmat4(1.0)};
        entry.space = world;
        if (isSceneFile(path))
            addScene(path, JsonNode::read(path), entry, roots_, 1);
        else
            addModel(path, entry, std::nullopt, roots_);
    }

private:
    void requireRoom(std::size_t more, const std::string& name) {
        placed_ += more;
        if (placed_ > kMaxPlaced)
            throw Error(ErrorKind::LimitExceeded,
                        fmt::format("{}: more than {} models, lights and cameras, instances counted each",
                                    name, kMaxPlaced));
    }

    void addModel(const std::string& path, const Entry& entry, const std::optional<Space>& stated,
                  const std::vector<std::string>& folders) {
        const Space space = stated.value_or(spaceOfFormat(path).value_or(entry.space));
        PlacedModel model{path, folders, entry.placements, entry.overrides, entry.lights, entry.cameras};
        for (glm::dmat4& placement : model.placements) placement *= change(space, entry.space);
        result.models.push_back(std::move(model));
    }

    void addScene(const std::string& path, const JsonNode& json, Entry outer,
                  const std::vector<std::string>& folders, unsigned depth) {
        if (depth > kMaxSceneDepth)
            throw Error(
                ErrorKind::InvalidContent,
                fmt::format("{}: is named by {} scene files, each in the one before", path, depth - 1));
        json.allow({"$schema", "units", "upAxis", "models", "materials", "lights", "cameras", "environment",
                    "background"});
        result.hasSceneFile = true;
        const ModelFolder folder(path, folders, asked_);
        Entry entry = std::move(outer);
        const Space space = readSpace(json, Space{});
        for (glm::dmat4& placement : entry.placements) placement *= change(space, entry.space);
        entry.space = space;
        addSurroundings(json, folder);
        addScenery(json, entry, path);
        const std::vector<std::uint32_t> own = readOverrides(json, folder);
        std::vector<std::string> below =
            folders; // what lies in this scene's folder is open to its models too
        below.push_back(std::filesystem::path(path).parent_path());
        if (const auto models = json.find("models"))
            for (const JsonNode& model : models->items()) addEntry(model, entry, own, folder, below, depth);
    }

    void addEntry(const JsonNode& json, const Entry& outer, const std::vector<std::uint32_t>& ofScene,
                  const ModelFolder& folder, const std::vector<std::string>& folders, unsigned depth) {
        json.allow({"file", "transform", "instances", "units", "upAxis", "materials", "lights", "cameras"});
        const std::string path = requireFile(json.at("file"), folder);
        Entry entry = outer;
        // What is more particular counts later, and what stands outside counts after all inside.
        const std::vector<std::uint32_t> own = readOverrides(json, folder);
        if (const auto lights = json.find("lights")) entry.lights = entry.lights && lights->truth();
        if (const auto cameras = json.find("cameras")) entry.cameras = entry.cameras && cameras->truth();
        for (const Instances& group : readInstances(json, folder)) {
            entry.placements = placementsOf(group, json, outer.placements);
            requireRoom(entry.placements.size(), json.place());
            entry.overrides = joined({ofScene, own, group.overrides, outer.overrides});
            addPlaced(path, json, entry, outer.space, folders, depth);
        }
    }

    void addPlaced(const std::string& path, const JsonNode& json, const Entry& entry, const Space& outer,
                   const std::vector<std::string>& folders, unsigned depth) {
        const bool hasSpace = json.find("units") || json.find("upAxis");
        if (isSceneFile(path)) {
            if (hasSpace) json.fail("units and upAxis are for models; a scene file states its own");
            addScene(path, JsonNode::read(path), entry, folders, depth + 1);
            return;
        }
        const Space usual = spaceOfFormat(path).value_or(outer);
        addModel(path, entry, hasSpace ? std::optional(readSpace(json, usual)) : std::nullopt, folders);
    }

    // Neighbours in the list share a group unless they have overrides.
    std::vector<Instances> readInstances(const JsonNode& json, const ModelFolder& folder) {
        const auto instances = json.find("instances");
        if (!instances) return {{{glm::dmat4(1.0)}, {}}};
        std::vector<Instances> groups;
        for (const JsonNode& instance : instances->items()) {
            const glm::dmat4 transform = readInstance(instance);
            const std::vector<std::uint32_t> overrides = readOverrides(instance, folder);
            if (groups.empty() || !overrides.empty() || !groups.back().overrides.empty())
                groups.push_back({{}, overrides});
            groups.back().transforms.push_back(transform);
        }
        if (groups.empty()) instances->fail("is empty; leave it out for the model as it stands");
        return groups;
    }

    // Each place of the scene times each instance times the transform of all of them.
    std::vector<glm::dmat4> placementsOf(const Instances& group, const JsonNode& json,
                                         const std::vector<glm::dmat4>& outer) {
        const auto transform = json.find("transform");
        const glm::dmat4 shared = transform ? readTransform(*transform) : glm::dmat4(1.0);
        if (group.transforms.size() > kMaxPlaced / outer.size()) requireRoom(kMaxPlaced, json.place());
        std::vector<glm::dmat4> all;
        for (const glm::dmat4& placement : outer)
            for (const glm::dmat4& instance : group.transforms)
                all.push_back(placement * (instance * shared));
        return all;
    }

    std::vector<std::uint32_t> readOverrides(const JsonNode& json, const ModelFolder& folder) {
        std::vector<std::uint32_t> indices;
        const auto materials = json.find("materials");
        if (!materials) return indices;
        for (const JsonNode& material : materials->items()) {
            indices.push_back(static_cast<std::uint32_t>(result.overrides.size()));
            result.overrides.push_back(readOverride(material, folder));
        }
        return indices;
    }

    void addScenery(const JsonNode& json, const Entry& entry, const std::string& path) {
        const auto lights = json.find("lights"), cameras = json.find("cameras");
        for (const JsonNode& item : lights ? lights->items() : std::vector<JsonNode>{}) {
            const Light light = readLight(item);
            if (!entry.lights) continue;
            requireRoom(entry.placements.size(), path);
            for (const glm::dmat4& placement : entry.placements) {
                result.lights.push_back(placed(light, placement));
                if (!isValid(result.lights.back()))
                    item.fail("has a number that its transform makes too large");
            }
        }
        for (const JsonNode& item : cameras ? cameras->items() : std::vector<JsonNode>{}) {
            const DescribedCamera camera = readCamera(item, entry.space.up);
            if (!entry.cameras) continue;
            requireRoom(entry.placements.size(), path);
            for (const glm::dmat4& placement : entry.placements) {
                DescribedCamera copy{placed(camera.camera, placement), {}};
                for (const CameraKey& key : camera.path) copy.path.push_back(placed(key, placement));
                if (!isValid(copy.camera)) item.fail("has a number that its transform makes too large");
                result.cameras.push_back(std::move(copy));
            }
        }
    }

    // Those of the first scene file that has any, and of the outermost one.
    void addSurroundings(const JsonNode& json, const ModelFolder& folder) {
        Surroundings& ours = result.surroundings;
        if (const auto background = json.find("background")) {
            const glm::vec3 color = background->color(kMostFloat);
            if (ours.hasBackground)
                result.warnings.push_back(background->place() + ": another background counts");
            else
                std::copy(&color[0], &color[0] + 3, ours.background);
            ours.hasBackground = 1;
        }
        const auto environment = json.find("environment");
        if (!environment) return;
        if (result.hasEnvironment) {
            result.warnings.push_back(environment->place() + ": another environment counts");
            return;
        }
        result.environment = readEnvironment(*environment, folder, ours);
        if (!result.environment.warning.empty()) result.warnings.push_back(result.environment.warning);
        result.hasEnvironment = true;
    }

    const std::vector<std::string>& roots_;
    FilesAsked* asked_;
    std::size_t placed_ = 0;
};

} // namespace

bool isSceneFile(const std::string& path) {
    const std::filesystem::path name = std::filesystem::path(path).filename();
    return lowerExtension(path) == "json" && lowerExtension(name.stem()) == "scene";
}

SceneDescription describeScene(const std::vector<std::string>& inputs, const std::vector<std::string>& roots,
                               FilesAsked* asked) {
    Space world;
    const auto first = std::find_if(inputs.begin(), inputs.end(), isSceneFile);
    if (first != inputs.end())
        if (const JsonNode json = JsonNode::read(*first); json.isObject())
            world.metres = readSpace(json, world).metres;
    Describer describer(roots, asked);
    for (const std::string& input : inputs) describer.addInput(input, world);
    return std::move(describer.result);
}

} // namespace rt

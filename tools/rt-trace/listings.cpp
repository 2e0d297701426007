#include "tools/rt-trace/listings.h"

#include "common/binary_io.h"
#include "common/json_file.h"
#include "common/log.h"
#include "formats/atlas_file.h"
#include "tools/rt-trace/camera.h"
#include "tools/rt-trace/options.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <optional>

namespace rt {
namespace {

std::string memoryText(const GlDevice& device) {
    if (device.software) return "memory of this machine";
    std::string text = device.memory.bytes ? fmt::format("{} MiB", *device.memory.bytes >> 20) : "";
    if (device.memory.freeBytes)
        text += fmt::format("{}{} MiB free", text.empty() ? "" : ", ", *device.memory.freeBytes >> 20);
    return text.empty() ? "memory unknown" : text;
}

std::string cudaText(const GlDevice& device) {
    return device.cuda ? fmt::format("  cuda:{}", *device.cuda) : "";
}

template <class Number>
nlohmann::json orNull(const std::optional<Number>& value) {
    return value ? nlohmann::json(*value) : nlohmann::json();
}

std::string extentOf(const NamedCamera& camera) {
    if (camera.kind == kCameraPerspective) return fmt::format("  fov {:g}", camera.fovDegrees);
    return camera.kind == kCameraOrthographic ? fmt::format("  height {:g}", camera.height) : "";
}

// The first and the last frame of a camera's path, if it has one.
std::optional<std::array<double, 2>> framesOf(std::size_t camera, std::span<const CameraKey> keys) {
    const auto isOurs = [=](const CameraKey& key) { return key.camera == camera; };
    const auto first = std::find_if(keys.begin(), keys.end(), isOurs);
    if (first == keys.end()) return std::nullopt;
    return {{first->frame, std::find_if(keys.rbegin(), keys.rend(), isOurs)->frame}};
}

// Whoever wants JSON on standard output gets nothing else there.
void print(const TraceOptions& options, const std::string& text, const nlohmann::json& json) {
    const std::string& path = options.common.jsonPath;
    if (path != "-") writeFile("-", text);
    if (!path.empty()) writeJson(path, json);
}

} // namespace

std::string deviceList(std::span<const GlDevice> devices) {
    std::string text;
    for (const GlDevice& device : devices) {
        const char* const kind = device.software ? "software" : "hardware";
        if (device.problem.empty())
            text += fmt::format("{}  {}  {}  GL {}  {}  {}{}\n", device.index, kind, device.renderer,
                                device.version, device.driver, memoryText(device), cudaText(device));
        else
            text += fmt::format("{}  {}  cannot be used: {}\n", device.index, kind, device.problem);
    }
    return text;
}

nlohmann::json devicesToJson(std::span<const GlDevice> devices) {
    nlohmann::json list = nlohmann::json::array();
    for (const GlDevice& device : devices) {
        nlohmann::json entry = {{"index", device.index}, {"software", device.software}};
        if (device.problem.empty())
            entry.update({{"renderer", device.renderer},
                          {"version", device.version},
                          {"driver", device.driver},
                          {"cudaDevice", orNull(device.cuda)},
                          {"memoryBytes", orNull(device.memory.bytes)},
                          {"freeMemoryBytes", orNull(device.memory.freeBytes)}});
        else
            entry["problem"] = device.problem;
        list.push_back(entry);
    }
    return {{"devices", list}};
}

std::string cameraList(const Atlas& atlas) {
    std::string text;
    for (std::size_t i = 0; i < atlas.cameras.size(); ++i) {
        const NamedCamera& camera = atlas.cameras[i];
        text += fmt::format("{}  {}{}  eye {:g},{:g},{:g}  look-at {:g},{:g},{:g}", nameOf(camera),
                            viewName(camera.kind), extentOf(camera), camera.eye[0], camera.eye[1],
                            camera.eye[2], camera.lookAt[0], camera.lookAt[1], camera.lookAt[2]);
        if (const auto frames = framesOf(i, atlas.cameraKeys))
            text += fmt::format("  frames {:g}-{:g}", (*frames)[0], (*frames)[1]);
        text += "\n";
    }
    return text;
}

nlohmann::json camerasToJson(const Atlas& atlas) {
    nlohmann::json list = nlohmann::json::array();
    for (std::size_t i = 0; i < atlas.cameras.size(); ++i) {
        const NamedCamera& camera = atlas.cameras[i];
        nlohmann::json& entry = list.emplace_back(nlohmann::json{{"name", nameOf(camera)},
                                                                 {"projection", viewName(camera.kind)},
                                                                 {"eye", camera.eye},
                                                                 {"lookAt", camera.lookAt},
                                                                 {"up", camera.up}});
        if (camera.kind == kCameraPerspective)
            entry.update({{"fovDegrees", camera.fovDegrees},
                          {"lensRadius", camera.lensRadius},
                          {"focusDistance", camera.focusDistance}});
        if (camera.kind == kCameraOrthographic) entry["height"] = camera.height;
        if (const auto frames = framesOf(i, atlas.cameraKeys)) entry["frames"] = *frames;
    }
    return {{"cameras", list}};
}

void printDevices(const TraceOptions& options) {
    const std::vector<GlDevice> devices = listGlDevices();
    print(options, deviceList(devices), devicesToJson(devices));
}

void printCameras(const TraceOptions& options) {
    const AtlasFile file = readAtlas(options.scenePath);
    if (file.atlas.cameras.empty()) logInfo(options.scenePath + ": has no cameras");
    print(options, cameraList(file.atlas), camerasToJson(file.atlas));
}

} // namespace rt

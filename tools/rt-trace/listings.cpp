#include "tools/rt-trace/listings.h"

#include "common/binary_io.h"
#include "common/json_file.h"
#include "common/log.h"
#include "formats/atlas_file.h"
#include "tools/rt-trace/camera.h"
#include "tools/rt-trace/options.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace rt {
namespace {

std::string memoryText(const GlDevice& device) {
    if (device.software) return "memory of this machine";
    std::string text = device.memory.bytes ? fmt::format("{} MiB", *device.memory.bytes >> 20) : "";
    if (device.memory.freeBytes)
        text += fmt::format("{}{} MiB free", text.empty() ? "" : ", ", *device.memory.freeBytes >> 20);
    return text.empty() ? "memory unknown" : text;
}

nlohmann::json orNull(const std::optional<std::uint64_t>& value) {
    return value ? nlohmann::json(*value) : nlohmann::json();
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
            text += fmt::format("{}  {}  {}  GL {}  {}  {}\n", device.index, kind, device.renderer,
                                device.version, device.driver, memoryText(device));
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
                          {"memoryBytes", orNull(device.memory.bytes)},
                          {"freeMemoryBytes", orNull(device.memory.freeBytes)}});
        else
            entry["problem"] = device.problem;
        list.push_back(entry);
    }
    return {{"devices", list}};
}

std::string cameraList(std::span<const NamedCamera> cameras) {
    std::string text;
    for (const NamedCamera& camera : cameras) {
        const bool perspective = camera.kind == kCameraPerspective;
        text += fmt::format("{}  {}  {}  eye {:g},{:g},{:g}  look-at {:g},{:g},{:g}\n", nameOf(camera),
                            viewName(camera.kind),
                            perspective ? fmt::format("fov {:g}", camera.fovDegrees)
                                        : fmt::format("height {:g}", camera.height),
                            camera.eye[0], camera.eye[1], camera.eye[2], camera.lookAt[0], camera.lookAt[1],
                            camera.lookAt[2]);
    }
    return text;
}

nlohmann::json camerasToJson(std::span<const NamedCamera> cameras) {
    nlohmann::json list = nlohmann::json::array();
    for (const NamedCamera& camera : cameras) {
        nlohmann::json& entry = list.emplace_back(nlohmann::json{{"name", nameOf(camera)},
                                                                 {"projection", viewName(camera.kind)},
                                                                 {"eye", camera.eye},
                                                                 {"lookAt", camera.lookAt},
                                                                 {"up", camera.up}});
        if (camera.kind == kCameraPerspective)
            entry.update({{"fovDegrees", camera.fovDegrees},
                          {"lensRadius", camera.lensRadius},
                          {"focusDistance", camera.focusDistance}});
        else
            entry["height"] = camera.height;
    }
    return {{"cameras", list}};
}

void printDevices(const TraceOptions& options) {
    const std::vector<GlDevice> devices = listGlDevices();
    print(options, deviceList(devices), devicesToJson(devices));
}

void printCameras(const TraceOptions& options) {
    const AtlasFile file = readAtlas(options.scenePath);
    const std::span<const NamedCamera> cameras = file.atlas.cameras;
    if (cameras.empty()) logInfo(options.scenePath + ": has no cameras");
    print(options, cameraList(cameras), camerasToJson(cameras));
}

} // namespace rt

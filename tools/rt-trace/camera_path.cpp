#include "tools/rt-trace/camera_path.h"

#include "common/binary_io.h"
#include "common/error.h"

#include <fmt/format.h>
#include <glm/common.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

namespace rt {
namespace {

[[noreturn]] void throwInvalid(const std::string& path, const std::string& what) {
    throw Error(ErrorKind::InvalidContent, fmt::format("{}: {}", path, what));
}

double numberOf(const nlohmann::json& value, const std::string& path, const std::string& what) {
    if (!value.is_number() || !std::isfinite(value.get<double>())) throwInvalid(path, what + " is no number");
    return value.get<double>();
}

glm::dvec3 pointOf(const nlohmann::json& value, const std::string& path, const std::string& what) {
    if (!value.is_array() || value.size() != 3) throwInvalid(path, what + " is not [x, y, z]");
    return {numberOf(value[0], path, what), numberOf(value[1], path, what), numberOf(value[2], path, what)};
}

CameraKey keyOf(const nlohmann::json& value, const std::string& path, std::size_t index) {
    const auto name = [&](const char* field) { return fmt::format("camera {}: {}", index, field); };
    if (!value.is_object()) throwInvalid(path, fmt::format("camera {} is no object", index));
    for (const char* field : {"frame", "eye", "lookAt"})
        if (!value.contains(field)) throwInvalid(path, name(field) + " is missing");
    CameraKey key;
    for (const auto& [field, content] : value.items()) {
        if (field == "frame")
            key.frame = numberOf(content, path, name("frame"));
        else if (field == "eye")
            key.eye = pointOf(content, path, name("eye"));
        else if (field == "lookAt")
            key.lookAt = pointOf(content, path, name("lookAt"));
        else if (field == "up")
            key.up = pointOf(content, path, name("up"));
        else if (field == "fov")
            key.fovDegrees = numberOf(content, path, name("fov"));
        else
            throwInvalid(path,
                         fmt::format("camera {}: '{}' is none of frame, eye, lookAt, up, fov", index, field));
    }
    return key;
}

} // namespace

std::vector<CameraKey> readCameraPath(const std::string& path) {
    const SharedSpan<std::byte> bytes = readFile(path);
    const auto* const text = reinterpret_cast<const char*>(bytes.data());
    const nlohmann::json json = nlohmann::json::parse(text, text + bytes.size(), nullptr, false);
    if (!json.is_array() || json.empty())
        throwInvalid(path, "is not a JSON array of cameras {frame, eye, lookAt, up, fov}");
    std::vector<CameraKey> keys;
    for (const nlohmann::json& value : json) keys.push_back(keyOf(value, path, keys.size()));
    const auto before = [](const CameraKey& a, const CameraKey& b) { return a.frame < b.frame; };
    std::sort(keys.begin(), keys.end(), before);
    for (std::size_t i = 1; i < keys.size(); ++i)
        if (keys[i].frame == keys[i - 1].frame)
            throwInvalid(path, fmt::format("frame {} is there twice", keys[i].frame));
    return keys;
}

CameraRequest cameraAt(std::span<const CameraKey> keys, double frame, const CameraRequest& request) {
    const auto behind =
        std::find_if(keys.begin(), keys.end(), [=](const CameraKey& key) { return key.frame >= frame; });
    const CameraKey& b = behind == keys.end() ? keys.back() : *behind;
    const CameraKey& a = behind == keys.begin() ? b : *(behind - 1);
    const double part =
        b.frame > a.frame ? std::clamp((frame - a.frame) / (b.frame - a.frame), 0.0, 1.0) : 0.0;
    CameraRequest at = request;
    at.eye = glm::mix(a.eye, b.eye, part);
    at.lookAt = glm::mix(a.lookAt, b.lookAt, part);
    at.up = glm::mix(a.up, b.up, part);
    if (request.view.value_or(kPerspectiveView) == kPerspectiveView)
        at.fovDegrees = glm::mix(a.fovDegrees, b.fovDegrees, part);
    return at;
}

} // namespace rt

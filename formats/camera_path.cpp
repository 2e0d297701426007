#include "formats/camera_path.h"

#include "common/json_reader.h"

#include <fmt/format.h>

#include <cmath>

namespace rt {
namespace {

constexpr double kLastFrame = 999'999.0;

double frameOf(const JsonNode& json, const std::vector<CameraKey>& before) {
    const double frame = json.number(0.0, kLastFrame);
    if (frame != std::floor(frame)) json.fail(fmt::format("{} is no whole number, as frames are", frame));
    if (!before.empty() && frame <= before.back().frame)
        json.fail(fmt::format("{} does not come after {}, the frame before it", frame, before.back().frame));
    return frame;
}

CameraKey keyOf(const JsonNode& json, const CameraKey& usual, const std::vector<CameraKey>& before) {
    json.allow({"frame", "eye", "lookAt", "up", "fov"});
    CameraKey key = usual;
    key.frame = frameOf(json.at("frame"), before);
    key.eye = json.at("eye").point();
    key.lookAt = json.at("lookAt").point();
    if (const auto up = json.find("up")) key.up = up->point();
    if (const auto fov = json.find("fov")) key.fovDegrees = viewAngleOf(*fov);
    return key;
}

} // namespace

double viewAngleOf(const JsonNode& json) {
    const double degrees = json.number();
    if (!(degrees > 0.0 && degrees < 180.0))
        json.fail(fmt::format("{:g} is not between 0 and 180 degrees", degrees));
    return degrees;
}

std::vector<CameraKey> cameraPathOf(const JsonNode& json, const CameraKey& usual) {
    std::vector<CameraKey> keys;
    if (json.isArray())
        for (const JsonNode& item : json.items()) keys.push_back(keyOf(item, usual, keys));
    if (keys.empty()) json.fail("is no JSON array of cameras {frame, eye, lookAt, up, fov}");
    return keys;
}

} // namespace rt

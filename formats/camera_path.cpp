#include "formats/camera_path.h"

#include "common/json_reader.h"

#include <fmt/format.h>

#include <algorithm>

namespace rt {
namespace {

CameraKey keyOf(const JsonNode& json, const CameraKey& usual) {
    json.allow({"frame", "eye", "lookAt", "up", "fov"});
    CameraKey key = usual;
    key.frame = json.at("frame").number();
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
        for (const JsonNode& item : json.items()) keys.push_back(keyOf(item, usual));
    if (keys.empty()) json.fail("is no JSON array of cameras {frame, eye, lookAt, up, fov}");
    const auto before = [](const CameraKey& a, const CameraKey& b) { return a.frame < b.frame; };
    std::sort(keys.begin(), keys.end(), before);
    for (std::size_t i = 1; i < keys.size(); ++i)
        if (keys[i].frame == keys[i - 1].frame)
            json.fail(fmt::format("frame {} is there twice", keys[i].frame));
    return keys;
}

} // namespace rt

#include "tools/rt-import/describe_scenery.h"

#include "common/error.h"
#include "common/json_reader.h"
#include "formats/camera_path.h"
#include "tools/rt-import/load_images.h"
#include "tools/rt-import/model_folder.h"
#include "tools/rt-import/place_scenery.h"

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace rt {
namespace {

constexpr double kUsualFovDegrees = 40.0; // as rt-trace has it
constexpr double kLeastSine = 1e-6;       // between a camera's view and up

glm::dvec3 axisOf(UpAxis axis) {
    return {axis == UpAxis::X ? 1.0 : 0.0, axis == UpAxis::Y ? 1.0 : 0.0, axis == UpAxis::Z ? 1.0 : 0.0};
}

glm::dmat4 readMatrix(const JsonNode& json) {
    const std::vector<JsonNode> numbers = json.items(16);
    glm::dmat4 matrix;
    for (int i = 0; i < 16; ++i) matrix[i / 4][i % 4] = numbers[static_cast<std::size_t>(i)].number();
    for (int column = 0; column < 4; ++column)
        if (matrix[column][3] != (column == 3 ? 1.0 : 0.0))
            json.fail("its last row is not 0, 0, 0, 1; numbers stand column by column");
    return matrix;
}

// Degrees about x, then y, then z; or about one axis.
glm::dmat4 readRotation(const JsonNode& json) {
    if (json.isArray()) {
        const glm::dvec3 turns = glm::radians(json.point());
        glm::dmat4 matrix(1.0);
        for (int axis = 2; axis >= 0; --axis)
            matrix = glm::rotate(matrix, turns[axis], axisOf(static_cast<UpAxis>(axis)));
        return matrix;
    }
    json.allow({"axis", "degrees"});
    return glm::rotate(glm::dmat4(1.0), glm::radians(json.at("degrees").number()),
                       json.at("axis").direction());
}

glm::dvec3 readScale(const JsonNode& json) {
    return json.isNumber() ? glm::dvec3(json.number()) : json.point();
}

glm::dmat4 transformOf(const JsonNode& json) {
    const auto given = json.find("matrix"), move = json.find("translate"), turn = json.find("rotate"),
               scale = json.find("scale");
    if (given && (move || turn || scale)) json.fail("has a matrix and translate, rotate or scale");
    glm::dmat4 matrix = given ? readMatrix(*given) : glm::dmat4(1.0);
    if (move) matrix = glm::translate(matrix, move->point());
    if (turn) matrix *= readRotation(*turn);
    if (scale) matrix = glm::scale(matrix, readScale(*scale));
    const double determinant = glm::determinant(glm::dmat3(matrix));
    if (!std::isnormal(determinant)) json.fail("flattens or overflows what it moves");
    return matrix;
}

// "direction", or "lookAt" as seen from the light's position.
glm::dvec3 readDirection(const JsonNode& json, const glm::dvec3& position) {
    const auto direction = json.find("direction"), lookAt = json.find("lookAt");
    if (direction.has_value() == lookAt.has_value()) json.fail("needs either direction or lookAt");
    if (direction) return direction->direction();
    const glm::dvec3 view = lookAt->point() - position;
    if (!(glm::length(view) > 0.0)) lookAt->fail("is where the light stands");
    return glm::normalize(view);
}

void readSpot(const JsonNode& json, const glm::dvec3& position, Light& light) {
    const auto angle = [&](const char* key, double usual, double most) {
        const auto found = json.find(key);
        return found ? found->number(0.0, most) : std::min(usual, most);
    };
    const double outer = angle("outerAngle", 45.0, 180.0);
    const double inner = angle("innerAngle", 0.0, outer);
    light.direction =
        vec4(vec3(readDirection(json, position)), static_cast<float>(std::cos(glm::radians(outer))));
    light.edgeU.w = std::max(static_cast<float>(std::cos(glm::radians(inner))), light.direction.w);
}

void readRectangle(const JsonNode& json, const glm::dvec3& position, Light& light) {
    const glm::dvec3 facing = readDirection(json, position);
    const auto given = json.find("up");
    glm::dvec3 up = given ? given->direction() : glm::dvec3(0.0, 1.0, 0.0);
    if (!given && std::abs(facing.y) > 0.999) up = {0.0, 0.0, 1.0};
    const glm::dvec3 across = glm::cross(facing, up);
    if (!(glm::length(across) > kLeastSine))
        json.at("up").fail("is parallel to the way that the light faces");
    const glm::dvec3 u = glm::normalize(across), v = glm::cross(u, facing);
    setRectangle(u * (0.5 * json.at("width").positive()), v * (0.5 * json.at("height").positive()), facing,
                 glm::dmat3(1.0), light);
}

void allowLightKeys(const JsonNode& json, std::uint32_t kind) {
    switch (kind) {
    case kLightPoint:
        return json.allow({"kind", "intensity", "position"});
    case kLightDirectional:
        return json.allow({"kind", "intensity", "direction"});
    case kLightSpot:
        return json.allow(
            {"kind", "intensity", "position", "direction", "lookAt", "outerAngle", "innerAngle"});
    case kLightRectangle:
        return json.allow({"kind", "intensity", "position", "direction", "lookAt", "up", "width", "height"});
    default:
        return json.allow({"kind", "intensity", "position", "radius"});
    }
}

void store(const glm::dvec3& from, double (&to)[3]) {
    for (int i = 0; i < 3; ++i) to[i] = from[i];
}

void readName(const JsonNode& json, NamedCamera& camera) {
    const std::string name = json.text();
    if (name.size() >= sizeof camera.name)
        json.fail(
            fmt::format("has {} bytes; a camera's name may have {}", name.size(), sizeof camera.name - 1));
    name.copy(camera.name, name.size());
}

void requireView(const JsonNode& json, const glm::dvec3& eye, const glm::dvec3& lookAt,
                 const glm::dvec3& up) {
    const glm::dvec3 view = lookAt - eye;
    if (!(glm::length(view) > 0.0)) json.fail("eye and lookAt are the same point");
    const double sine = glm::length(glm::cross(glm::normalize(view), glm::normalize(up)));
    if (!(sine >= kLeastSine)) json.fail("up is 0 or parallel to the view");
}

void readLens(const JsonNode& json, NamedCamera& camera, double lookAtDistance) {
    if (const auto radius = json.find("lensRadius")) camera.lensRadius = radius->number(0.0, kMostFloat);
    if (camera.lensRadius > 0.0) camera.focusDistance = lookAtDistance;
    if (const auto focus = json.find("focus")) camera.focusDistance = focus->positive();
}

// What only one kind of camera has.
void readView(const JsonNode& json, double fovDegrees, double lookAtDistance, NamedCamera& camera) {
    if (camera.kind == kCameraPanorama) return json.allow({"name", "kind", "eye", "lookAt", "up", "path"});
    if (camera.kind == kCameraOrthographic) {
        json.allow({"name", "kind", "eye", "lookAt", "up", "path", "height"});
        camera.height = json.at("height").positive();
        return;
    }
    json.allow({"name", "kind", "eye", "lookAt", "up", "path", "fov", "lensRadius", "focus"});
    camera.fovDegrees = fovDegrees;
    readLens(json, camera, lookAtDistance);
}

} // namespace

UpAxis readUpAxis(const JsonNode& json) {
    return static_cast<UpAxis>(json.choice({"x", "y", "z"}));
}

double readUnit(const JsonNode& json) {
    if (json.isNumber()) return json.positive();
    constexpr std::array<double, 6> kMetres = {1.0, 0.01, 0.001, 1000.0, 0.0254, 0.3048};
    return kMetres[json.choice({"m", "cm", "mm", "km", "in", "ft"})];
}

glm::dmat4 yUpFrom(UpAxis axis) {
    glm::dmat4 matrix(1.0);
    if (axis == UpAxis::X) matrix = {{0, 1, 0, 0}, {-1, 0, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}};
    if (axis == UpAxis::Z) matrix = {{1, 0, 0, 0}, {0, 0, -1, 0}, {0, 1, 0, 0}, {0, 0, 0, 1}};
    return matrix;
}

glm::dmat4 readTransform(const JsonNode& json) {
    json.allow({"matrix", "translate", "rotate", "scale"});
    return transformOf(json);
}

glm::dmat4 readInstance(const JsonNode& json) {
    json.allow({"matrix", "translate", "rotate", "scale", "materials"});
    return transformOf(json);
}

Light readLight(const JsonNode& json) {
    Light light{};
    light.kind.x = static_cast<std::uint32_t>(
        json.at("kind").choice({"point", "directional", "spot", "rectangle", "sphere"}));
    allowLightKeys(json, light.kind.x);
    light.intensity = vec4(json.at("intensity").color(kMostFloat), 0.0f);
    if (light.kind.x == kLightDirectional) {
        light.direction = vec4(vec3(json.at("direction").direction()), 0.0f);
        return light;
    }
    const glm::dvec3 position = json.at("position").point();
    light.position = vec4(vec3(position), 0.0f);
    if (light.kind.x == kLightSpot) readSpot(json, position, light);
    if (light.kind.x == kLightRectangle) readRectangle(json, position, light);
    if (light.kind.x == kLightSphere) light.position.w = static_cast<float>(json.at("radius").positive());
    if (!isValid(light)) json.fail("has a number that is too large or too small");
    return light;
}

DescribedCamera readCamera(const JsonNode& json, UpAxis upAxis) {
    DescribedCamera result{};
    NamedCamera& camera = result.camera;
    readName(json.at("name"), camera);
    if (const auto kind = json.find("kind"))
        camera.kind = static_cast<std::uint32_t>(kind->choice({"perspective", "orthographic", "panorama"}));
    const auto path = json.find("path");
    CameraKey start;
    start.up = axisOf(upAxis);
    start.fovDegrees = kUsualFovDegrees;
    if (const auto up = json.find("up")) start.up = up->direction();
    if (const auto fov = json.find("fov")) start.fovDegrees = viewAngleOf(*fov);
    if (path) {
        result.path = cameraPathOf(*path, start);
        for (const CameraKey& key : result.path) requireView(*path, key.eye, key.lookAt, key.up);
        start = result.path.front();
    }
    if (const auto eye = json.find("eye"); eye || !path) start.eye = json.at("eye").point();
    if (const auto lookAt = json.find("lookAt"); lookAt || !path) start.lookAt = json.at("lookAt").point();
    requireView(json, start.eye, start.lookAt, start.up);
    store(start.eye, camera.eye);
    store(start.lookAt, camera.lookAt);
    store(start.up, camera.up);
    readView(json, start.fovDegrees, glm::distance(start.eye, start.lookAt), camera);
    return result;
}

EnvironmentPicture readEnvironment(const JsonNode& json, const ModelFolder& folder,
                                   Surroundings& surroundings) {
    json.allow({"file", "color", "strength", "turn"});
    const auto file = json.find("file"), color = json.find("color");
    if (file.has_value() == color.has_value()) json.fail("needs either file or color");
    if (const auto strength = json.find("strength"))
        surroundings.strength = static_cast<float>(strength->number(0.0, kMostFloat));
    if (const auto turn = json.find("turn"))
        surroundings.turnDegrees = static_cast<float>(std::fmod(turn->number(), 360.0));
    EnvironmentPicture picture;
    if (color) {
        picture = evenEnvironment(color->color(kMostFloat));
    } else {
        const std::string path = requireFile(*file, folder);
        if (!isEnvironmentFile(path)) file->fail("ends neither in .exr nor in .hdr");
        picture = readEnvironment(path);
    }
    if (picture.width > kMaxImageSide || picture.height > kMaxImageSide)
        throw Error(ErrorKind::LimitExceeded,
                    fmt::format("{}: {}x{} pixels exceed {} on a side; scale it down", file->text(),
                                picture.width, picture.height, kMaxImageSide));
    surroundings.width = picture.width;
    surroundings.height = picture.height;
    return picture;
}

} // namespace rt

#include "tools/rt-trace/parse_light.h"

#include "common/command_line.h"
#include "common/error.h"
#include "tools/rt-trace/option_values.h"

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include <cmath>

namespace rt {
namespace {

constexpr const char* kOption = "--light";

[[noreturn]] void throwUsage(const std::string& text, const std::string& what) {
    throw Error(ErrorKind::Usage, fmt::format("{} {}: {}", kOption, text, what));
}

using Numbers = std::vector<double>; // those of a light's form, without its colour

glm::dvec3 pointAt(const Numbers& v, std::size_t first) {
    return {v[first], v[first + 1], v[first + 2]};
}

glm::dvec3 directionOf(const glm::dvec3& way, const std::string& text) {
    const double length = glm::length(way);
    if (!(length > 0.0) || !std::isfinite(length)) throwUsage(text, "it shines in no direction");
    return way / length;
}

void shapeDirectional(const Numbers& v, const std::string& text, LightRequest& light) {
    light.shape.direction = glm::vec4(directionOf(pointAt(v, 0), text), 0.0f);
    light.position = glm::dvec3(0.0);
}

void shapeSpot(const Numbers& v, const std::string& text, LightRequest& light) {
    const double outer = v[6], inner = v[7];
    if (!(outer > 0.0 && outer <= 90.0 && inner >= 0.0 && inner <= outer))
        throwUsage(text, fmt::format("half angles are 0 <= INNER <= OUTER <= 90 degrees, not {} and {}",
                                     inner, outer));
    light.shape.direction =
        glm::vec4(directionOf(pointAt(v, 3) - light.position, text), std::cos(glm::radians(outer)));
    light.shape.edgeU.w = static_cast<float>(std::cos(glm::radians(inner)));
}

void shapeRectangle(const Numbers& v, const std::string& text, LightRequest& light) {
    if (!(v[6] > 0.0 && v[7] > 0.0)) throwUsage(text, "its width and height are above 0");
    const glm::dvec3 facing = directionOf(pointAt(v, 3) - light.position, text);
    const glm::dvec3 y(0.0, 1.0, 0.0);
    const bool vertical = glm::length(glm::cross(facing, y)) < 1e-6;
    const glm::dvec3 level = glm::normalize(glm::cross(facing, vertical ? glm::dvec3(0.0, 0.0, 1.0) : y));
    light.shape.direction = glm::vec4(facing, 0.0f);
    light.shape.edgeU = glm::vec4(level * (0.5 * v[6]), 0.0f);
    light.shape.edgeV = glm::vec4(glm::cross(level, facing) * (0.5 * v[7]), 0.0f);
}

void shapeSphere(const Numbers& v, const std::string& text, LightRequest& light) {
    if (!(v[3] > 0.0)) throwUsage(text, "its radius is above 0");
    light.shape.position.w = static_cast<float>(v[3]);
}

struct LightForm {
    const char* name;
    std::size_t numbers;
    std::uint32_t kind;
    void (*shape)(const Numbers&, const std::string& text, LightRequest&);
};
constexpr LightForm kForms[] = {
    {"point", 3, kLightPoint, [](const Numbers&, const std::string&, LightRequest&) {}},
    {"directional", 3, kLightDirectional, shapeDirectional},
    {"spot", 8, kLightSpot, shapeSpot},
    {"rectangle", 8, kLightRectangle, shapeRectangle},
    {"sphere", 4, kLightSphere, shapeSphere},
};

const LightForm& formNamed(const std::string& name, const std::string& text) {
    for (const LightForm& form : kForms)
        if (name == form.name) return form;
    throwUsage(text, fmt::format("'{}' is none of point, directional, spot, rectangle, sphere", name));
}

} // namespace

LightRequest parseLight(const std::string& text) {
    const std::size_t colon = text.find(':');
    const bool named = colon != std::string::npos;
    const LightForm& form = named ? formNamed(text.substr(0, colon), text) : kForms[0];
    const std::string numbers = named ? text.substr(colon + 1) : text;
    const std::size_t count = countNumbers(numbers);
    if (count != form.numbers && count != form.numbers + 3)
        throwUsage(text, fmt::format("a {} light has {} numbers, or {} with R,G,B, not {}", form.name,
                                     form.numbers, form.numbers + 3, count));
    const Numbers v = parseNumbers(numbers, count, kOption);
    LightRequest light;
    light.position = pointAt(v, 0);
    if (count > form.numbers) light.intensity = toColor(v[count - 3], v[count - 2], v[count - 1], kOption);
    light.shape.kind.x = form.kind;
    form.shape(v, text, light);
    return light;
}

} // namespace rt

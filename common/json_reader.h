#pragma once
#include "common/error.h"

#include <glm/vec3.hpp>
#include <nlohmann/json_fwd.hpp>

#include <initializer_list>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace rt {

inline constexpr std::size_t kMaxJsonBytes = std::size_t(1) << 24;
inline constexpr unsigned kMaxJsonDepth = 32;
inline constexpr double kMostFloat = std::numeric_limits<float>::max(); ///< for number() and color()

/// A value of a JSON file that somebody wrote, and its place there: what is asked of it and does not hold
/// ends in Error{InvalidContent}, "scene.json: /models/0/file: is no text".
class JsonNode {
public:
    /// The file's whole value. Throws Error{FileAccess}, Error{LimitExceeded} above kMaxJsonBytes, or
    /// Error{InvalidContent} for what is no JSON, goes deeper than kMaxJsonDepth, or has a key twice in one
    /// object.
    static JsonNode read(const std::string& path);
    /// As read(), of a text that errors call `name`.
    static JsonNode parse(std::string_view text, const std::string& name);

    [[noreturn]] void fail(const std::string& what, ErrorKind kind = ErrorKind::InvalidContent) const;
    /// "scene.json: /models/0/file".
    std::string place() const;

    bool isObject() const;
    bool isArray() const;
    bool isNumber() const;
    bool isText() const;
    bool isNull() const;

    /// Fails unless it is an object that has none but these keys.
    void allow(std::initializer_list<std::string_view> keys) const;
    std::optional<JsonNode> find(const char* key) const;  ///< of an object; nothing where it is absent
    JsonNode at(const char* key) const;                   ///< fails where it is absent
    std::vector<JsonNode> items() const;                  ///< of an array
    std::vector<JsonNode> items(std::size_t count) const; ///< of an array that has so many

    double number() const; ///< finite
    double number(double low, double high) const;
    double positive() const;
    bool truth() const;
    std::string text() const; ///< not empty
    /// Index of its text among these.
    std::size_t choice(std::initializer_list<std::string_view> names) const;
    glm::dvec3 point() const;           ///< [x, y, z]
    glm::dvec3 direction() const;       ///< [x, y, z] of some length, which it comes without
    glm::vec3 color(double most) const; ///< one number or [r, g, b], 0 to `most`

private:
    JsonNode(std::shared_ptr<const nlohmann::json> owner, const nlohmann::json& value, std::string file,
             std::string pointer);
    JsonNode child(const nlohmann::json& value, const std::string& key) const;

    std::shared_ptr<const nlohmann::json> owner_; // of the whole file
    const nlohmann::json* value_;
    std::string file_;
    std::string pointer_; // RFC 6901
};

} // namespace rt

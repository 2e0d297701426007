#include "common/json_reader.h"

#include "common/binary_io.h"
#include "common/error.h"

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

namespace rt {
namespace {

using nlohmann::json;

// Refuses what the library would take: a key twice, of which the last would count, and nesting without end.
// Looks at the text before it is parsed: the parser's own callback takes quadratic time in long arrays.
class TextRules : public nlohmann::json_sax<json> {
public:
    explicit TextRules(const std::string& name) : name_(name) {}

    bool null() override { return true; }
    bool boolean(bool) override { return true; }
    bool number_integer(number_integer_t) override { return true; }
    bool number_unsigned(number_unsigned_t) override { return true; }
    bool number_float(number_float_t, const string_t&) override { return true; }
    bool string(string_t&) override { return true; }
    bool binary(binary_t&) override { return true; }
    bool start_object(std::size_t) override { return enter(); }
    bool start_array(std::size_t) override { return enter(); }
    bool end_object() override { return leave(); }
    bool end_array() override { return leave(); }
    bool key(string_t& key) override {
        if (!keys_.back().insert(key).second)
            fail(fmt::format("the key '{}' is there twice in one object", key));
        return true;
    }
    bool parse_error(std::size_t, const std::string&, const json::exception&) override {
        return false; // parsing says what it is
    }

private:
    bool enter() {
        if (keys_.size() >= kMaxJsonDepth) fail(fmt::format("is nested deeper than {}", kMaxJsonDepth));
        keys_.emplace_back();
        return true;
    }
    bool leave() {
        keys_.pop_back();
        return true;
    }
    [[noreturn]] void fail(const std::string& what) const {
        throw Error(ErrorKind::InvalidContent, name_ + ": " + what);
    }

    const std::string& name_;
    std::vector<std::set<std::string>> keys_; // of each object or array that is open
};

// "parse error at line 1, column 2: ..." without the library's own number in front.
std::string reasonOf(const json::exception& error) {
    const std::string text = error.what();
    const std::size_t end = text.find("] ");
    return end == std::string::npos ? text : text.substr(end + 2);
}

std::string escaped(const std::string& key) {
    std::string result;
    for (const char c : key) {
        if (c == '~')
            result += "~0";
        else if (c == '/')
            result += "~1";
        else
            result += static_cast<unsigned char>(c) < 32 ? '?' : c;
    }
    return result;
}

} // namespace

JsonNode::JsonNode(std::shared_ptr<const json> owner, const json& value, std::string file,
                   std::string pointer)
    : owner_(std::move(owner)), value_(&value), file_(std::move(file)), pointer_(std::move(pointer)) {}

JsonNode JsonNode::read(const std::string& path) {
    StreamRule rule; // a device may have no end
    rule.memory = MemoryLimit{kMaxJsonBytes + 1, "what JSON may have"};
    const SharedSpan<std::byte> bytes = readFile(path, rule);
    if (bytes.size() > kMaxJsonBytes)
        throw Error(ErrorKind::LimitExceeded,
                    fmt::format("{}: {} bytes; JSON may have {}", path, bytes.size(), kMaxJsonBytes));
    return parse({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, path);
}

JsonNode JsonNode::parse(std::string_view text, const std::string& name) {
    std::shared_ptr<const json> owner;
    try {
        TextRules rules(name);
        json::sax_parse(text.begin(), text.end(), &rules);
        owner = std::make_shared<const json>(json::parse(text.begin(), text.end()));
    } catch (const json::exception& error) {
        throw Error(ErrorKind::InvalidContent, fmt::format("{}: is no JSON: {}", name, reasonOf(error)));
    }
    const json& value = *owner;
    return {std::move(owner), value, name, ""};
}

void JsonNode::fail(const std::string& what, ErrorKind kind) const {
    throw Error(kind, place() + ": " + what);
}

std::string JsonNode::place() const {
    return fmt::format("{}: {}", file_, pointer_.empty() ? "/" : pointer_);
}

bool JsonNode::isObject() const {
    return value_->is_object();
}
bool JsonNode::isArray() const {
    return value_->is_array();
}
bool JsonNode::isNumber() const {
    return value_->is_number();
}
bool JsonNode::isText() const {
    return value_->is_string();
}
bool JsonNode::isNull() const {
    return value_->is_null();
}

JsonNode JsonNode::child(const json& value, const std::string& key) const {
    return {owner_, value, file_, pointer_ + "/" + escaped(key)};
}

void JsonNode::allow(std::initializer_list<std::string_view> keys) const {
    if (!isObject()) fail(fmt::format("is no object {{{}}}", fmt::join(keys, ", ")));
    for (const auto& [key, ignored] : value_->items())
        if (std::find(keys.begin(), keys.end(), key) == keys.end())
            fail(fmt::format("'{}' is none of {}", escaped(key), fmt::join(keys, ", ")));
}

std::optional<JsonNode> JsonNode::find(const char* key) const {
    if (!isObject()) fail("is no object");
    const auto found = value_->find(key);
    return found == value_->end() ? std::nullopt : std::optional<JsonNode>(child(*found, key));
}

JsonNode JsonNode::at(const char* key) const {
    auto found = find(key);
    if (!found) fail(fmt::format("{} is missing", key));
    return *found;
}

std::vector<JsonNode> JsonNode::items() const {
    if (!isArray()) fail("is no array");
    std::vector<JsonNode> nodes;
    for (const json& value : *value_) nodes.push_back(child(value, std::to_string(nodes.size())));
    return nodes;
}

std::vector<JsonNode> JsonNode::items(std::size_t count) const {
    if (!isArray() || value_->size() != count) fail(fmt::format("is no array of {}", count));
    return items();
}

double JsonNode::number() const {
    if (!isNumber() || !std::isfinite(value_->get<double>())) fail("is no number");
    return value_->get<double>();
}

double JsonNode::number(double low, double high) const {
    const double value = number();
    if (!(value >= low && value <= high))
        fail(high < std::numeric_limits<float>::max()
                 ? fmt::format("{:g} is not between {:g} and {:g}", value, low, high)
                 : fmt::format("{:g} is below {:g} or too large", value, low));
    return value;
}

double JsonNode::positive() const {
    const double value = number();
    if (!(value > 0.0)) fail(fmt::format("{:g} is not above 0", value));
    return value;
}

bool JsonNode::truth() const {
    if (!value_->is_boolean()) fail("is neither true nor false");
    return value_->get<bool>();
}

std::string JsonNode::text() const {
    if (!isText()) fail("is no text");
    const auto text = value_->get<std::string>();
    if (text.empty() ||
        std::any_of(text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < 32; }))
        fail("is empty or has control characters");
    return text;
}

std::size_t JsonNode::choice(std::initializer_list<std::string_view> names) const {
    const std::string given = isText() ? text() : "";
    const auto found = std::find(names.begin(), names.end(), given);
    if (found == names.end()) fail(fmt::format("is none of {}", fmt::join(names, ", ")));
    return static_cast<std::size_t>(found - names.begin());
}

glm::dvec3 JsonNode::point() const {
    if (!isArray() || value_->size() != 3) fail("is not [x, y, z]");
    const std::vector<JsonNode> parts = items();
    return {parts[0].number(), parts[1].number(), parts[2].number()};
}

glm::dvec3 JsonNode::direction() const {
    const glm::dvec3 given = point();
    const double largest = std::max({std::abs(given.x), std::abs(given.y), std::abs(given.z)});
    if (!(largest > 0.0)) fail("has no length");
    return glm::normalize(given / largest);
}

glm::vec3 JsonNode::color(double most) const {
    if (isNumber()) return glm::vec3(static_cast<float>(number(0.0, most)));
    if (!isArray() || value_->size() != 3) fail("is neither a number nor [r, g, b]");
    const std::vector<JsonNode> parts = items();
    return {parts[0].number(0.0, most), parts[1].number(0.0, most), parts[2].number(0.0, most)};
}

} // namespace rt

#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>

namespace rt {

/// `value`, indented, with a final newline. Numbers that are not finite become null.
std::string jsonText(const nlohmann::json& value);

/// Writes jsonText(); "-" is standard output.
void writeJson(const std::string& path, const nlohmann::json& value);

} // namespace rt

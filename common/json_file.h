#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>

namespace rt {

/// Writes `value`, indented, with a final newline; "-" is standard output. Numbers that are not finite become
/// null.
void writeJson(const std::string& path, const nlohmann::json& value);

} // namespace rt

#include "common/json_file.h"

#include "common/binary_io.h"

#include <nlohmann/json.hpp>

namespace rt {

std::string jsonText(const nlohmann::json& value) {
    // File names may hold bytes that are not UTF-8; they must not turn a finished run into an error.
    return value.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

void writeJson(const std::string& path, const nlohmann::json& value) {
    writeFile(path, jsonText(value));
}

} // namespace rt

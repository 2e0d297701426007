#pragma once
#include "formats/atlas.h"
#include "tools/rt-trace/gl_context.h"

#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>

namespace rt {

struct TraceOptions;

/// What --list-devices and --list-cameras print, and what --json holds then.
std::string deviceList(std::span<const GlDevice> devices);
nlohmann::json devicesToJson(std::span<const GlDevice> devices);
std::string cameraList(const Atlas& atlas);
nlohmann::json camerasToJson(const Atlas& atlas);

void printDevices(const TraceOptions& options);
void printCameras(const TraceOptions& options);

} // namespace rt

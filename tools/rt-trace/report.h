#pragma once
#include "common/stage_timer.h"
#include "tools/rt-trace/camera.h"
#include "tools/rt-trace/render.h"

#include <nlohmann/json_fwd.hpp>
#include <optional>

namespace rt {

struct GpuScene;

/// Adds what pictures and ray queries have in common: the device, the atlas, the features with their reasons,
/// and `loadMs`, `uploadMs`, ... for each stage.
void reportCommon(nlohmann::json& report, const GpuScene& scene, const StageTimer& stages);

/// Adds the parts of the atlas that were uploaded or not.
void reportSections(nlohmann::json& report, const GpuScene& scene, bool ownEnvironment);

/// Adds raysTotal, stepsPerRay, testsPerRay and mraysPerSecond, of work that took `gpuMs`.
void reportWork(nlohmann::json& report, const WorkTotals& work, double gpuMs);

/// Rays per second in millions; not a number where the time is 0.
double mraysPerSecond(std::uint64_t rays, double elapsedMs);

void reportCamera(nlohmann::json& report, const CameraPose& pose);

} // namespace rt

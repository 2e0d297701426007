#include "tools/rt-trace/load_scene.h"

#include "common/error.h"
#include "formats/parallel_check.h"
#include "tools/rt-trace/sample_slots.h"

#include <fmt/format.h>

#include <algorithm>

namespace rt {
namespace {

std::optional<ShaderCache> openCache(const TraceOptions& options, const GlLimits& limits) {
    if (options.noShaderCache || !limits.programBinaries) return std::nullopt;
    const std::optional<std::filesystem::path> folder = shaderCacheFolder();
    return folder ? std::optional<ShaderCache>(*folder) : std::nullopt;
}

GpuScene bringToDevice(const AtlasFile& file, const TraceOptions& options, ShaderKind kind,
                       const ChooseNeeds& choose, StageTimer& stages) {
    const std::string& name = options.scenePath;
    validateSizes(file.atlas, name);
    GpuScene scene;
    scene.file = file;
    stages.begin("context");
    scene.context = GlContext::open(options.device);
    const GlLimits& limits = scene.context->limits();
    stages.begin("plan");
    SceneNeeds needs = choose(file.atlas, limits);
    needs.features.doublePrecision = options.doublePrecision;
    needs.features.intersect = options.intersect;
    needs.features.software = scene.context->device().software;
    const bool multipass = needs.features.multipass != 0;
    if (kind == ShaderKind::Render && !multipass) needs.features.subgroups = limits.subgroups;
    scene.plan = planResources(file.atlas, needs.features, kind,
                               multipass ? limits.fragmentResources : limits.resources, name);
    needs.memory.push_back({"the atlas", uploadedBytes(file.atlas, scene.plan), kSmallerAtlas});
    scene.memoryBytes = sumOf(needs.memory);
    const std::optional<MemoryLimit> memory = gpuMemoryLimit(scene.context->device(), options.maxGpuMemory);
    requireGpuMemory(needs.memory, memory, name);
    if (kind == ShaderKind::Render) {
        const std::uint64_t left = memory ? memory->bytes - scene.memoryBytes : SampleSlots::kMostBytes;
        scene.mostSamples = std::min(needs.samples, left / 2 / slotLayout(scene.plan.features).bytes());
        scene.memoryBytes += SampleSlots::bytesFor(scene.plan.features, limits, scene.mostSamples);
    }
    scene.plan.features.countWork = 0;
    stages.begin("compile");
    scene.cache = openCache(options, limits);
    CompilingPrograms programs = startVariant(scene.plan, scene.shaderCache());
    scene.programsFromCache = programs.areFromCache();
    stages.begin("upload");
    scene.atlas = uploadAtlas(file.atlas, scene.plan, limits, needs.lightCount, name);
    stages.begin("compile");
    scene.programs = programs.finish();
    stages.begin("wait");
    return scene;
}

} // namespace

GpuScene loadScene(const TraceOptions& options, ShaderKind kind, const ChooseNeeds& choose,
                   StageTimer& stages) {
    const double startMs = programMs();
    const MappedAtlas mapped(options.scenePath);
    double endMs = startMs;
    const auto verify = [&] {
        mapped.verify();
        endMs = programMs();
    };
    GpuScene scene = whileChecking(verify, options.common.threads, [&] {
        return bringToDevice(mapped.unverified(), options, kind, choose, stages);
    });
    stages.end();
    stages.add("load", endMs - startMs);
    return scene;
}

void requireWholeWalks(std::size_t cutShort, const char* what, const std::string& name) {
    if (cutShort == 0) return;
    throw Error(ErrorKind::LimitExceeded,
                fmt::format("{}: {} {} need more steps and triangle tests than this software renderer does; "
                            "make the atlas with --structure nested or a higher --resolution",
                            name, cutShort, what));
}

} // namespace rt

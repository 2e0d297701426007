#include "tools/rt-trace/slot_layout.h"

#include "formats/gpu_interface.shared.h"

#include <fmt/format.h>

namespace rt {
namespace {

// Each hit takes one ray off a sample's stack and puts at most this many on it, each one deeper.
unsigned mostChildren(const SceneFeatures& f) {
    return (f.hasReflection | f.hasTransmission) + (f.hasReflection & f.hasRoughness) + f.hasTransmission +
           f.hasOpacity;
}

unsigned stackSize(const SceneFeatures& f) {
    const unsigned children = mostChildren(f);
    return children == 0 ? 0 : (children - 1) * f.maxDepth + 1;
}

} // namespace

SlotLayout slotLayout(const SceneFeatures& f) {
    SlotLayout layout;
    const auto place = [&](unsigned count) {
        const unsigned first = layout.planes;
        layout.planes += count;
        return first;
    };
    const bool tints = f.hasTransmission || f.hasOpacity;
    const bool manyJobs = f.hasOcclusion + f.lightCount + f.hasEnvironment > 1;
    const unsigned point = f.doublePrecision ? 2 : 1;
    layout.pointPlanes = point;
    if (!f.multipass) layout.firstHit = place(point);
    if (!f.multipass) layout.color = place(1);
    layout.albedo = place(f.hasAovs ? 1 : 0);
    layout.time = place(f.hasTime ? 1 : 0);
    layout.work = place(f.hasAovs || f.countWork ? 2 : 0);
    layout.resultPlanes = layout.planes;
    if (!f.multipass) layout.flight = place(2 * point);
    if (!f.multipass) layout.hit = place(point);
    layout.path = place(2);
    layout.arriving = place(tints ? 3 : 1);
    layout.lit = place(manyJobs ? 3 * point : 0);
    layout.stack = place(stackSize(f) * (2 * point + 2));
    if (f.multipass) { // in textures
        layout.color = layout.planes;
        layout.flight = layout.planes + 1;
        layout.hit = layout.firstHit = layout.planes + 3;
    }
    return layout;
}

std::string slotText(const SlotLayout& layout) {
    std::string text =
        fmt::format("layout(location = {}) uniform uint stage;\n"
                    "layout(location = {}) uniform uint roundInGroup;\n"
                    "layout(std430, binding = {}) restrict buffer SlotBlock {{ uvec4 slots[]; }};\n"
                    "layout(std430, binding = {}) restrict buffer RoundBlock {{ TraceRound rounds[{}]; uint "
                    "queue[]; }};\n"
                    "const uint kPointPlanes = {}u;\n",
                    RT_LOCATION_STAGE, RT_LOCATION_ROUND, RT_BUFFER_SLOTS, RT_BUFFER_ROUNDS,
                    kRoundsInGroup + 1, layout.pointPlanes);
    const std::pair<const char*, unsigned> parts[] = {
        {"FirstHit", layout.firstHit}, {"Hit", layout.hit},       {"Flight", layout.flight},
        {"Color", layout.color},       {"Path", layout.path},     {"Arriving", layout.arriving},
        {"Lit", layout.lit},           {"Albedo", layout.albedo}, {"Time", layout.time},
        {"Work", layout.work},         {"Stack", layout.stack}};
    for (const auto& [name, plane] : parts) text += fmt::format("const uint kPlane{} = {}u;\n", name, plane);
    return text + fmt::format("const uint kResultPlanes = {}u;\nconst uint kRecordPlanes = {}u;\n",
                              layout.resultPlanes, layout.planes - layout.resultPlanes);
}

} // namespace rt

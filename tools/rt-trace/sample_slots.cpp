#include "tools/rt-trace/sample_slots.h"

#include "formats/gpu_interface.shared.h"
#include "tools/rt-trace/shader_variant.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <array>

namespace rt {
namespace {

constexpr std::uint64_t kMostBytes = std::uint64_t(1) << 30;
constexpr std::uint64_t kMostSoftware = 1u << 15; // samples: more would not stay in caches
constexpr std::uint64_t kMostHardware = 1u << 22;
constexpr std::uint64_t kRoundBytes = sizeof(TraceRound) * (kRoundsInGroup + 1);

using Rounds = std::array<TraceRound, kRoundsInGroup + 1>;

unsigned slotCount(const SceneFeatures& features, const GlLimits& limits) {
    const std::uint64_t bytes = std::min(kMostBytes, limits.resources.storageBlockBytes);
    const std::uint64_t groups = std::min<std::uint64_t>(limits.groupCountX, 65535);
    return static_cast<unsigned>(std::min({bytes / slotLayout(features).bytes(), groups * kRaysPerGroup,
                                           features.software ? kMostSoftware : kMostHardware}));
}

unsigned groupsFor(unsigned samples) {
    return std::max((samples + kRaysPerGroup - 1) / kRaysPerGroup, 1u);
}

void setStage(unsigned stage, unsigned round) {
    glUniform1ui(RT_LOCATION_STAGE, stage);
    glUniform1ui(RT_LOCATION_ROUND, round);
}

// The first round of a group is `first`, all others are empty.
void resetRounds(const GlBuffer& buffer, const TraceRound& first) {
    Rounds rounds;
    rounds.fill({{0, 1, 1, 0}, {0, 0, 0, 0}});
    rounds[0] = first;
    updateBuffer(buffer, std::as_bytes(std::span(rounds)));
}

} // namespace

SampleSlots::SampleSlots(const SceneFeatures& features, const GlLimits& limits)
    : count_(slotCount(features, limits)), slots_(createOutputBuffer(count_ * slotLayout(features).bytes())),
      queue_(createDynamicBuffer(kRoundBytes + std::uint64_t(count_) * 2 * sizeof(std::uint32_t))) {}

void SampleSlots::bind() const {
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, RT_BUFFER_SLOTS, slots_.name());
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, RT_BUFFER_ROUNDS, queue_.name());
    glBindBuffer(GL_DISPATCH_INDIRECT_BUFFER, queue_.name());
    checkGl("binding the samples");
}

void SampleSlots::render(unsigned samples) {
    resetRounds(queue_, {});
    setStage(kStageBegin, 0);
    glDispatchCompute(groupsFor(samples), 1, 1);
    unsigned round = 1; // of its group
    unsigned taken = 0, wanted = rounds_;
    for (;;) {
        const unsigned end = std::min(round + wanted, kRoundsInGroup);
        for (; round < end; ++round, ++taken) {
            glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_COMMAND_BARRIER_BIT);
            setStage(kStageAdvance, round);
            glDispatchComputeIndirect(static_cast<GLintptr>(sizeof(TraceRound) * round));
        }
        glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
        TraceRound next;
        glGetNamedBufferSubData(queue_.name(), static_cast<GLintptr>(sizeof(TraceRound) * round),
                                sizeof(TraceRound), &next);
        if (next.groups.x == 0) break;
        wanted = 4;
        if (round < kRoundsInGroup) continue;
        static_assert(kRoundsInGroup % 2 == 0); // the same half of the queue
        resetRounds(queue_, next);
        round = 0;
    }
    rounds_ = taken;
    setStage(kStageResolve, 0);
    glDispatchCompute(groupsFor(samples), 1, 1);
}

} // namespace rt

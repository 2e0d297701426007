#include "tools/rt-trace/sample_slots.h"

#include "common/stage_timer.h"
#include "formats/gpu_interface.shared.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <array>

namespace rt {
namespace {

constexpr std::uint64_t kMostSoftware = 1u << 15; // samples: more would not stay in caches
constexpr unsigned kMoreRounds = 4;               // when those expected were not enough
constexpr std::uint64_t kMostHardware = 1u << 24;

using Rounds = std::array<TraceRound, kRoundsInGroup + 1>;

constexpr std::uint64_t kQueueBytes = 2 * sizeof(std::uint32_t); // of a slot

unsigned slotCount(const SceneFeatures& features, const GlLimits& limits, std::uint64_t most) {
    const std::uint64_t bytes = std::min(SampleSlots::kMostBytes, limits.resources.storageBlockBytes);
    const std::uint64_t groups = std::min<std::uint64_t>(limits.groupCountX, 1u << 20);
    const std::uint64_t wanted = std::max<std::uint64_t>(most, kRaysPerGroup);
    return static_cast<unsigned>(std::min({bytes / slotLayout(features).bytes(), groups * kRaysPerGroup,
                                           wanted, features.software ? kMostSoftware : kMostHardware}));
}

unsigned groupsFor(unsigned samples) {
    return std::max((samples + kRaysPerGroup - 1) / kRaysPerGroup, 1u);
}

void use(const GlProgram& program, unsigned stage, unsigned round) {
    glUseProgram(program.name());
    glUniform1ui(RT_LOCATION_STAGE, stage);
    glUniform1ui(RT_LOCATION_ROUND, round);
}

// Of `samples`, or of those in the round's queue.
void traceAndShade(const GpuPrograms& programs, unsigned stage, unsigned round, unsigned samples,
                   StageTimes* times) {
    const auto run = [&](const GlProgram& program) {
        glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_COMMAND_BARRIER_BIT);
        use(program, stage, round);
        if (stage == kStageBegin)
            glDispatchCompute(groupsFor(samples), 1, 1);
        else
            glDispatchComputeIndirect(static_cast<GLintptr>(sizeof(TraceRound) * round));
    };
    timed(times ? &times->traceMs : nullptr, [&] { run(programs.trace); });
    timed(times ? &times->shadeMs : nullptr, [&] { run(programs.shade); });
}

GlBuffer createNoRounds() {
    Rounds rounds;
    rounds.fill({{0, 1, 1, 0}, {0, 0, 0, 0}});
    return createBuffer(std::as_bytes(std::span(rounds)));
}

// `count` rounds.
void copyRounds(const GlBuffer& from, unsigned first, const GlBuffer& to, unsigned at, unsigned count) {
    constexpr auto kBytes = static_cast<GLintptr>(sizeof(TraceRound));
    glCopyNamedBufferSubData(from.name(), to.name(), first * kBytes, at * kBytes, count * kBytes);
}

} // namespace

void timed(double* ms, const std::function<void()>& work) {
    if (!ms) return work();
    glFinish();
    const double beginMs = programMs();
    work();
    glFinish();
    *ms += programMs() - beginMs;
}

SampleSlots::SampleSlots(const SceneFeatures& features, const GlLimits& limits, std::uint64_t most)
    : count_(slotCount(features, limits, most)),
      slots_(createOutputBuffer(count_ * slotLayout(features).bytes())) {}

std::uint64_t SampleSlots::bytesFor(const SceneFeatures& features, const GlLimits& limits,
                                    std::uint64_t most) {
    const std::uint64_t queueBytes = features.multipass ? 0 : kQueueBytes;
    return slotCount(features, limits, most) * (slotLayout(features).bytes() + queueBytes);
}

void SampleSlots::bind() const {
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, RT_BUFFER_SLOTS, slots_.name());
    checkGl("binding the samples");
}

SampleRounds::SampleRounds(unsigned slots)
    : rounds_(createOutputBuffer(sizeof(Rounds) + slots * kQueueBytes)), noRounds_(createNoRounds()),
      answer_(createDynamicBuffer(sizeof(TraceRound))) {}

void SampleRounds::bind() const {
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, RT_BUFFER_ROUNDS, rounds_.name());
    glBindBuffer(GL_DISPATCH_INDIRECT_BUFFER, rounds_.name());
    checkGl("binding the rounds");
}

// Whether the round has anything to do.
bool SampleRounds::isWanted(unsigned round) {
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
    copyRounds(rounds_, round, answer_, 0, 1);
    TraceRound answer;
    readBuffer(answer_, std::as_writable_bytes(std::span(&answer, 1)));
    return answer.groups.x > 0;
}

void SampleRounds::render(const GpuPrograms& programs, unsigned samples, StageTimes* times) {
    copyRounds(noRounds_, 0, rounds_, 0, kRoundsInGroup + 1);
    traceAndShade(programs, kStageBegin, 0, samples, times);
    unsigned round = 1, taken = 0, due = expected_;
    do {
        if (round == kRoundsInGroup) { // becomes the next group's first
            static_assert(kRoundsInGroup % 2 == 0, "its queue is the same");
            copyRounds(rounds_, kRoundsInGroup, rounds_, 0, 1);
            copyRounds(noRounds_, 1, rounds_, 1, kRoundsInGroup);
            round = 0;
        }
        const unsigned end = std::min(round + due, kRoundsInGroup);
        taken += end - round;
        for (; round < end; ++round) traceAndShade(programs, kStageAdvance, round, 0, times);
        due = kMoreRounds;
    } while (isWanted(round));
    expected_ = taken;
    timed(times ? &times->resolveMs : nullptr, [&] {
        use(programs.shade, kStageResolve, 0);
        glDispatchCompute(groupsFor(samples), 1, 1);
    });
}

} // namespace rt

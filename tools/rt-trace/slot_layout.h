#pragma once
#include "tools/rt-trace/scene_features.h"

#include <cstdint>
#include <string>

namespace rt {

/// How samples wait in memory between two rays: planes of 16 bytes for each slot, one plane after the other.
/// The shader's part is shaders/path.glsl. With --kernel multipass color, flight and hit have numbers from
/// `planes` on, and are textures (RayPasses).
struct SlotLayout {
    unsigned pointPlanes = 0; ///< of a point or direction and a word with it
    // The first plane of each part; parts that a variant does not have are empty.
    unsigned firstHit = 0, hit = 0, flight = 0, color = 0, path = 0, arriving = 0, lit = 0, albedo = 0,
             time = 0, work = 0, stack = 0;
    unsigned resultPlanes = 0; ///< firstHit, color, albedo, time, work
    unsigned planes = 0;

    std::uint64_t bytes() const { return std::uint64_t(planes) * 16; } ///< of a slot
};
SlotLayout slotLayout(const SceneFeatures& features);

/// GLSL that declares the slots, the rounds and where the planes are.
std::string slotText(const SlotLayout& layout);

} // namespace rt

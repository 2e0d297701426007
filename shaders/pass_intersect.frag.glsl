// First of the three passes: each ray on its way is tested against the triangles of the voxel that it is in.
#include "formats/shared_types.shared.h"
#include "formats/octahedral.shared.h"
#include "formats/material.shared.h"
#include "formats/atlas.shared.h"
#include "formats/gpu_interface.shared.h"
#include "shaders/features.glsl"
#include "shaders/resources.glsl"
#include "shaders/real.glsl"
#include "shaders/ray.glsl"
#include "shaders/random.glsl"
#include "shaders/texture.glsl"
#include "shaders/intersect.glsl"
#include "shaders/traverse.glsl"
#include "shaders/view.glsl"
#include "shaders/path.glsl"
#include "shaders/batch.glsl"
#include "shaders/pass.glsl"

layout(early_fragment_tests) in;
layout(location = 0) out uvec4 hitTarget;

void main() {
    findTexel();
    Progress p = loadProgress();
    if (!isUnderWay(p)) discard; // shaded a moment ago, and no ray has followed
    bool begun = p.phase == kBegun;
    loadFlight();
    Ray ray = flight.ray;
    real tEnter;
    enterGrid(ray, tEnter);
    Hit best = Hit(ray.tMax, 0.0f, 0.0f, kNoTriangle);
    if (!begun) best = loadHit(false);
    WorkCounters work = WorkCounters(0u, 1u, 0u, 0u);
    if (p.word >= kOccupiedBit) intersectList(ray, shearAlong(ray.direction), p.word, best, work);
    if (kSoftware && walkCutShort) best.triangle = kWalkCutShort;
    storeHit(false, best);
    if (kCountWork) countWork(false, work);
    hitTarget = hitWords;
}

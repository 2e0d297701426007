// Second of the three passes: each ray on its way goes on to the next voxel, or behind the empty space round the one that it is in.
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

layout(location = 0) out uvec4 progressTarget;

void main() {
    findTexel();
    Progress p = loadProgress();
    if (!isUnderWay(p)) discard;
    loadFlight();
    Ray ray = flight.ray;
    real tEnter;
    enterGrid(ray, tEnter);
    Hit best = loadHit(false);
    p.phase = kLanded;
    bool isFound = best.triangle != kNoTriangle && (flight.anyHit || best.triangle == kWalkCutShort);
    if (!isFound) {
        GridRay g = toGridRay(ray);
        uint word = p.word >= kOccupiedBit ? loadReference(leafList(p.word)) : p.word;
        real t = leap(g, word, p.sizeShift, p.at);
        ivec3 voxel = p.at ^ g.toVoxel;
        if (!endsAt(t, voxel, best)) {
            p.phase = kWalking;
            p.word = lookUp(voxel, p.sizeShift);
        }
    }
    progressTarget = p.phase == kWalking ? wordsOf(p) : uvec4(kLanded << kPlaceBits, uvec3(0u));
}

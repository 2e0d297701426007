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

// One step; returns whether the walk is over.
bool stepOn(inout Progress p) {
    loadFlight();
    Ray ray = flight.ray;
    real tEnter;
    enterGrid(ray, tEnter);
    Hit best = loadHit(false);
    if (best.triangle == kWalkCutShort || (flight.anyHit && best.triangle != kNoTriangle)) return true;
    GridRay g = toGridRay(ray);
    uint word = p.word >= kOccupiedBit ? loadReference(leafList(p.word)) : p.word;
    real t = leap(g, word, p.sizeShift, p.at);
    ivec3 voxel = p.at ^ g.toVoxel;
    if (endsAt(t, voxel, best)) return true;
    p.word = lookUp(voxel, p.sizeShift);
    return false;
}

void main() {
    findTexel();
    Progress p = loadProgress();
    if (p.phase == kResting) discard;
    gl_FragDepth = kDepthLanded;
    if (p.phase == kEnded) {
        p.phase = kResting;
        gl_FragDepth = kDepthNothing;
    } else if (isUnderWay(p)) {
        if (stepOn(p)) {
            p.phase = kLanded;
            p.at = ivec3(kPlaceZero);
        } else {
            p.phase = kWalking;
            gl_FragDepth = kCountWork || p.word >= kOccupiedBit ? kDepthTriangles : kDepthNothing;
        }
    }
    progressTarget = wordsOf(p);
}

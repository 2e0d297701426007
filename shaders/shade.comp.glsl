// What follows from the hits of a round: each invocation adds the light that one sample's ray has found, and finds the sample's next
// ray. When no sample has one left, one more dispatch adds all to their pixels, in their order.
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
#include "shaders/surface.glsl"
#include "shaders/reflectance.glsl"
#include "shaders/environment.glsl"
#include "shaders/lights.glsl"
#include "shaders/view.glsl"

layout(local_size_x = RT_GROUP_X, local_size_y = 1) in;
#include "shaders/lanes.glsl"
#include "shaders/path.glsl"
#include "shaders/slots.glsl"
#include "shaders/queue.glsl"
#include "shaders/batch.glsl"
#include "shaders/shade.glsl"
#include "shaders/follow.glsl"

void shade(bool first) {
    Place place = placeOf(sampleNumber);
    Hit hit = loadHit(first);
    if (first) {
        flight = primaryFlight(place);
        if (hit.triangle != kNoTriangle) slot = takeSlot();
        beginSample(place);
    } else {
        loadState();
    }
    bool goesOn = false;
    if (kSoftware && hit.triangle == kWalkCutShort) sampleColor.a = kCutShort;
    else goesOn = follow(hit, place.pixel, place.index, samplerOf(place.pixel, place.index));
    storeSample();
    if (!goesOn) return;
    enqueue();
    storeFlight();
    storeState();
}

void main() {
    sampleNumber = gl_GlobalInvocationID.x;
    if (stage == kStageResolve) {
        if (isBegun(sampleNumber, 1u)) resolve(placeOf(sampleNumber).pixel);
    } else {
        bool first = stage == kStageBegin;
        if (first ? isBegun(sampleNumber, picture.samples.y) : takeFromQueue()) {
            Clock begun = readClock();
            if (!first) loadFlight();
            shade(first);
            addTime(begun, false);
        }
    }
}

// Third of the three passes: each ray whose walk is over gets its light, and the sample's next ray takes its place, in four targets.
// Before the first of them it begins the samples, after the last it adds them to their pixels.
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
#include "shaders/intersect.glsl"
#include "shaders/traverse.glsl"
#include "shaders/view.glsl"
#include "shaders/path.glsl"
#include "shaders/batch.glsl"
#include "shaders/pass.glsl"
#include "shaders/shade.glsl"
#include "shaders/follow.glsl"

layout(early_fragment_tests) in;
layout(location = 0) out uvec4 colorTarget;
layout(location = 1) out uvec4 originTarget;
layout(location = 2) out uvec4 directionTarget;
layout(location = 3) out uvec4 progressTarget;

// What the ray that has ended at `p` has met.
Hit hitAt(Progress p) {
    Ray ray = flight.ray;
    real tEnter;
    Hit hit = Hit(0.0f, 0.0f, 0.0f, kNoTriangle);
    if (p.phase == kLanded) hit = loadHit(false);
    enterGrid(ray, tEnter);
    return hitOf(flight.ray, tEnter, hit);
}

// As shade() of shade.comp.glsl; true if the sample has another ray.
bool advance(Place place, Progress p) {
    loadFlight();
    loadState();
    originWords = loadWords(kPlaneFlight);
    directionWords = loadWords(kPlaneFlight + 1u);
    Hit hit = hitAt(p);
    bool hitsItself = hit.triangle == flight.from && hit.triangle != kNoTriangle;
    bool goesOn = false;
    if (kSoftware && hit.triangle == kWalkCutShort) sampleColor.a = kCutShort;
    else goesOn = follow(hit, place.pixel, place.index, samplerOf(place.pixel, place.index));
    if (kCountWork) countWork(false, WorkCounters(uint(goesOn), 0u, 0u, uint(hitsItself)));
    return goesOn;
}

bool begin(Place place) {
    flight = primaryFlight(place);
    beginSample(place);
    if (kCountWork) countWork(true, WorkCounters(1u, 0u, 0u, 0u));
    return true;
}

void main() {
    findTexel();
    Place place = placeOfTexel();
    if (stage == kStageResolve) {
        resolve(place.pixel);
        discard;
    }
    bool goesOn = stage == kStageBegin ? begin(place) : advance(place, loadProgress());
    Progress p = Progress(kEnded, ivec3(kPlaceZero), 0, 0u);
    storeSample();
    if (goesOn) {
        storeFlight();
        storeState();
        p = beginProgress(flight.ray);
    }
    colorTarget = colorWords;
    originTarget = originWords;
    directionTarget = directionWords;
    progressTarget = wordsOf(p);
}

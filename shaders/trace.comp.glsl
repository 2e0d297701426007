// One round of a batch: each invocation traces one ray of one sample; in the first round its primary ray. Nothing else is done here, so
// that the walk has the registers that it wants.
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

layout(local_size_x = RT_GROUP_X, local_size_y = 1) in;
#include "shaders/lanes.glsl"
#include "shaders/path.glsl"
#include "shaders/slots.glsl"
#include "shaders/queue.glsl"
#include "shaders/batch.glsl"

void main() {
    sampleNumber = gl_GlobalInvocationID.x;
    bool first = stage == kStageBegin;
    if (!(first ? isBegun(sampleNumber, picture.samples.y) : takeFromQueue())) return;
    Clock begun = readClock();
    if (first) flight = primaryFlight(placeOf(sampleNumber));
    else loadFlight();
    WorkCounters work = WorkCounters(0u, 0u, 0u, 0u);
    Hit hit = trace(flight.ray, flight.anyHit, work);
    if (kCountWork && hit.triangle == flight.from && hit.triangle != kNoTriangle) work.selfHits += 1u;
    if (kSoftware && walkCutShort) hit.triangle = kWalkCutShort;
    storeHit(first, hit);
    if (kCountWork) countWork(first, work);
    addTime(begun, first);
}

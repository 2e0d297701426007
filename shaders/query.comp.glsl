// One ray of a batch per invocation: raw rays in, raw hits out.
#include "formats/shared_types.shared.h"
#include "formats/atlas.shared.h"
#include "formats/gpu_interface.shared.h"
#include "shaders/features.glsl"
#include "shaders/resources.glsl"
#include "shaders/real.glsl"
#include "shaders/ray.glsl"
#include "shaders/intersect.glsl"
#include "shaders/traverse.glsl"
#include "shaders/query_ray.glsl"

layout(local_size_x = RT_GROUP_X, local_size_y = 1) in;

void main() {
    uint index = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * uint(RT_GROUP_X) + gl_LocalInvocationID.x;
    if (index >= query.count.x) return;
    HitRecord result = kMiss;
    WorkCounters work = WorkCounters(0u, 0u, 0u, 0u);
    QueryRay next = rays[index];
    if (isTraceable(next)) {
        real tScale;
        Hit hit = trace(toAtlas(next, tScale), kAnyHit, work);
        if (hit.triangle != kNoTriangle) result = record(hit.t * tScale, hit);
    }
    if (kSoftware && walkCutShort) result = kCut;
    hits[index] = result;
#if RT_COUNT_WORK
    counters[index] = uvec4(work.rays, work.steps, work.tests, 0u);
#endif
}

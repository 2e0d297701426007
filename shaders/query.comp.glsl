// Rays of a batch: raw rays in, raw hits out. One per invocation, or, where neighbours go different ways, each invocation
// takes another one as soon as enough of those that run side by side have done theirs (Aila & Laine 2009).
#include "formats/shared_types.shared.h"
#include "formats/atlas.shared.h"
#include "formats/gpu_interface.shared.h"
#include "shaders/features.glsl"
#include "shaders/resources.glsl"
#include "shaders/real.glsl"
#include "shaders/ray.glsl"
#include "shaders/intersect.glsl"
#include "shaders/traverse.glsl"
#include "shaders/lanes.glsl"
#include "shaders/walk.glsl"

layout(local_size_x = RT_GROUP_X, local_size_y = 1) in;

// False for directions without a way to go: zero or not finite, and for origins that are not finite.
bool isTraceable(vec3 origin, vec3 direction) {
    vec3 size = abs(direction);
    bool finite = all(lessThanEqual(size, vec3(3.4e38f))) && all(lessThanEqual(abs(origin), vec3(3.4e38f)));
    return finite && max(size.x, max(size.y, size.z)) > 0.0f;
}

// Largest power of two that is not above the largest component, as an exponent.
int scaleExponent(vec3 direction) {
    vec3 size = abs(direction);
    return int(floatBitsToUint(max(size.x, max(size.y, size.z))) >> 23) - 127;
}

// The ray in atlas space, and what its t are to be multiplied by: world t = atlas t * tScale. World to atlas space, and the
// direction to about unit size, are powers of two, so nothing is rounded but the origin's offset. False if there is no
// way to go.
bool loadRay(uint index, out Ray ray, out real tScale) {
    vec4 originTmin = rays[index].originTmin;
    vec4 directionTmax = rays[index].directionTmax;
    int exponent = scaleExponent(directionTmax.xyz);
    real directionScale = powerOfTwo(clamp(-exponent, -126, 127));
    tScale = directionScale / grid.worldOffset.w;
    real3 origin = (real3(originTmin.xyz) - grid.worldOffset.xyz) * grid.worldOffset.w;
    ray = Ray(origin, directionTmax.xyz * directionScale, max(originTmin.w, 0.0f) / tScale, min(directionTmax.w / tScale, real(3.4e38f)));
    bool hasLength = originTmin.w <= directionTmax.w; // false for NaN
    return hasLength && isTraceable(originTmin.xyz, directionTmax.xyz);
}

// `hit` with t in world space.
void store(uint index, Hit hit, WorkCounters work) {
    if (hit.triangle == kNoTriangle) hit = Hit(-1.0f, 0.0f, 0.0f, kNoTriangle);
#if RT_DOUBLE
    hits[index] = QueryHitDouble(hit.t, hit.u, hit.v, hit.triangle, 0u);
#else
    hits[index].tuvId = uvec4(floatBitsToUint(vec3(hit.t, hit.u, hit.v)), hit.triangle);
#endif
#if RT_COUNT_WORK
    counters[index] = uvec4(work.rays, work.steps, work.tests, 0u);
#endif
}

#if RT_SCATTERED_RAYS
const uint kEnoughIdle = 20u; // of 32 lanes; measured
// Then another lane must go on: Mesa's software renderer, which has no subgroups, ends any loop after 65,535 rounds.
const uint kMostRaysPerLane = kSubgroups ? 0xFFFFFFFFu : 2u * kRaysPerLane;

// Whose turn it is. Lanes that ask together get neighbours.
uint takeRay() {
#if RT_SUBGROUPS
    uvec4 lanes = subgroupBallot(true);
    uint first = 0u;
    if (subgroupElect()) first = atomicAdd(nextRay, subgroupBallotBitCount(lanes));
    return subgroupBroadcastFirst(first) + subgroupBallotExclusiveBitCount(lanes);
#else
    return atomicAdd(nextRay, 1u);
#endif
}

void main() {
    uint index = query.count.x; // of the ray that walks; none yet
    real tScale;
    real tEnter;
    Walk w;
    w.walking = false;
    w.entryAt = 0u;
    WorkCounters work;
    uint taken = 0u;
    for (bool more = true; more;) {
        bool refill = lanesWhere(!w.walking) * 32u >= lanesWhere(true) * kEnoughIdle;
        if (refill && !w.walking) {
            if (index < query.count.x) {
                w.best.t = (w.best.t + tEnter) * tScale;
                store(index, w.best, work);
            }
            index = taken++ < kMostRaysPerLane ? takeRay() : query.count.x;
            more = index < query.count.x;
            if (more) {
                Ray ray;
                bool traceable = loadRay(index, ray, tScale);
                work = WorkCounters(traceable ? 1u : 0u, 0u, 0u);
                bool enters = enterGrid(ray, tEnter);
                w = beginWalk(ray);
                w.walking = traceable && enters;
            }
        }
        advance(w, kAnyHit, work);
    }
}
#else
void main() {
    uint index = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * uint(RT_GROUP_X) + gl_LocalInvocationID.x;
    if (index >= query.count.x) return;
    WorkCounters work = WorkCounters(0u, 0u, 0u);
    Hit hit = Hit(0.0f, 0.0f, 0.0f, kNoTriangle);
    Ray ray;
    real tScale;
    if (loadRay(index, ray, tScale)) hit = trace(ray, kAnyHit, work);
    hit.t *= tScale;
    store(index, hit, work);
}
#endif

// One ray of a batch per invocation: raw rays in, raw hits out.
#include "formats/shared_types.shared.h"
#include "formats/atlas.shared.h"
#include "formats/gpu_interface.shared.h"
#include "shaders/features.glsl"
#include "shaders/resources.glsl"
#include "shaders/ray.glsl"
#include "shaders/intersect.glsl"
#include "shaders/traverse.glsl"

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

uint invocationIndex() {
    return (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * uint(RT_GROUP_X) + gl_LocalInvocationID.x;
}

void main() {
    uint index = invocationIndex();
    if (index >= query.count.x) return;
    vec4 originTmin = rays[index].originTmin;
    vec4 directionTmax = rays[index].directionTmax;
    QueryHit result = QueryHit(uvec4(floatBitsToUint(-1.0f), 0u, 0u, kNoTriangle));
    WorkCounters work = WorkCounters(0u, 0u, 0u);
    bool hasLength = originTmin.w <= directionTmax.w; // false for NaN
    if (hasLength && isTraceable(originTmin.xyz, directionTmax.xyz)) {
        // World to atlas space, and the direction to about unit size; both by powers of two, so nothing is rounded but
        // the origin's offset. World t = atlas t * tScale.
        int exponent = scaleExponent(directionTmax.xyz);
        float directionScale = powerOfTwo(clamp(-exponent, -126, 127));
        float tScale = directionScale / grid.worldOffset.w;
        vec3 origin = (originTmin.xyz - grid.worldOffset.xyz) * grid.worldOffset.w;
        Ray ray = Ray(origin, directionTmax.xyz * directionScale, max(originTmin.w, 0.0f) / tScale, min(directionTmax.w / tScale, 3.4e38f));
        Hit hit = trace(ray, kAnyHit, work);
        if (hit.triangle != kNoTriangle)
            result.tuvId = uvec4(floatBitsToUint(vec3(hit.t * tScale, hit.u, hit.v)), hit.triangle);
    }
    hits[index] = result;
#if RT_COUNT_WORK
    counters[index] = uvec4(work.rays, work.steps, work.tests, 0u);
#endif
}

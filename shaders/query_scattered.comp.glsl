// Rays of a batch of which neighbours go different ways: an invocation takes the next one from a queue as soon as most of
// those that run beside it have done theirs (Aila & Laine 2009).
#include "formats/shared_types.shared.h"
#include "formats/atlas.shared.h"
#include "formats/gpu_interface.shared.h"
#include "shaders/features.glsl"
#include "shaders/resources.glsl"
#include "shaders/real.glsl"
#include "shaders/ray.glsl"
#include "shaders/intersect.glsl"
#include "shaders/traverse.glsl"
#include "shaders/walk.glsl"
#include "shaders/query_ray.glsl"

layout(local_size_x = RT_GROUP_X, local_size_y = 1) in;
#include "shaders/lanes.glsl"

const uint kEnoughIdle = 20u; // of 32 lanes; measured

void main() {
    uint index = query.count.x; // of the ray that walks; none yet
    real tScale;
    real tEnter;
    Walk w;
    w.walking = false;
    w.entryAt = 0u;
    WorkCounters work;
    uint taken = 0u;
    bool more = true;
    while (more) {
        bool refill = lanesWhere(!w.walking) * 32u >= lanesWhere(true) * kEnoughIdle;
        if (refill && !w.walking) {
            if (index < query.count.x) {
                hits[index] = w.best.triangle == kNoTriangle ? kMiss : record((w.best.t + tEnter) * tScale, w.best);
#if RT_COUNT_WORK
                counters[index] = uvec4(work.rays, work.steps, work.tests, 0u);
#endif
            }
            more = taken++ < query.count.y;
            if (more) {
                // Lanes that ask together get neighbours.
                uint asking = lanesWhere(true);
                uint rank = rankWhere(true);
                uint first = 0u;
                if (isFirstLane()) first = atomicAdd(nextRay, asking);
                index = fromFirstLane(first) + rank;
                more = index < query.count.x;
            }
            if (more) {
                QueryRay next = rays[index];
                bool traceable = isTraceable(next);
                work = WorkCounters(traceable ? 1u : 0u, 0u, 0u, 0u);
                Ray ray = toAtlas(next, tScale);
                bool enters = enterGrid(ray, tEnter);
                w = beginWalk(ray);
                w.walking = traceable && enters;
            }
        }
        advance(w, kAnyHit, work);
    }
    if (kSoftware && more && index < query.count.x) hits[index] = kCut;
}

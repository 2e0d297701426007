// Walks a ray through the voxel grid (Amanatides & Woo 1987), leaping over empty space as far as the voxel's proximity
// value allows (Cohen & Sheffer 1994). Numerics: shaders/README.md.

const float kNever = 1e30f;

// The part of a ray that lies in the grid, in voxel units: position = origin + t * direction.
struct GridRay {
    vec3 origin;
    vec3 direction;
    vec3 inverse; // 1 / direction; kNever where the direction is 0
    bvec3 positive; // direction >= 0
};

// Distance at which the ray enters the box [lo, hi] (x) and leaves it (y); x > y if it misses.
vec2 boxSpan(Ray ray, vec3 lo, vec3 hi) {
    bvec3 still = equal(ray.direction, vec3(0.0f));
    vec3 inverse = 1.0f / ray.direction;
    vec3 a = (lo - ray.origin) * inverse;
    vec3 b = (hi - ray.origin) * inverse;
    bvec3 outside = bvec3(uvec3(lessThan(ray.origin, lo)) | uvec3(greaterThan(ray.origin, hi)));
    vec3 near = mix(min(a, b), mix(vec3(-kNever), vec3(kNever), outside), still);
    vec3 far = mix(max(a, b), vec3(kNever), still);
    return vec2(max(near.x, max(near.y, near.z)), min(far.x, min(far.y, far.z)));
}

// A component that is nothing beside the largest one becomes 0: its inverse would overflow, and even from 10^9 scene
// sizes away it cannot move the ray by a rounding error.
vec3 withoutTinyComponents(vec3 direction) {
    vec3 size = abs(direction);
    float largest = max(size.x, max(size.y, size.z));
    return mix(direction, vec3(0.0f), lessThan(size, vec3(largest * 1e-20f)));
}

// `base` is the ray moved to where it enters the grid.
GridRay toGridRay(Ray base) {
    GridRay g;
    g.origin = (base.origin - grid.gridLo.xyz) * grid.cellsPerUnit.xyz;
    g.direction = base.direction * grid.cellsPerUnit.xyz;
    bvec3 still = equal(g.direction, vec3(0.0f));
    g.inverse = mix(1.0f / g.direction, vec3(kNever), still);
    // Keeps a ray that runs inside a voxel face in the middle of its voxels, where no exit plane is 0 away.
    g.origin = mix(g.origin, floor(clamp(g.origin, vec3(0.0f), vec3(grid.dims.xyz) - 1.0f)) + 0.5f, still);
    g.positive = greaterThanEqual(g.direction, vec3(0.0f));
    return g;
}

// How many voxels beyond this one are free of triangles on every side.
int freeReach(uint word) {
    return kStructure == kStructureCloud ? int(word) - 1 : 0;
}

// The voxel behind the exit face of the box of `reach` voxels round `cell`; tExit receives when the ray gets there.
ivec3 nextVoxel(GridRay g, ivec3 cell, int reach, out float tExit) {
    ivec3 lo = cell - mix(ivec3(reach), ivec3(0), g.positive); // never step back: rounding at a face would
    ivec3 hi = cell + mix(ivec3(0), ivec3(reach), g.positive); // revisit this voxel for ever
    vec3 plane = mix(vec3(lo), vec3(hi + 1), g.positive);
    vec3 t = (plane - g.origin) * g.inverse;
    tExit = min(t.x, min(t.y, t.z));
    bvec3 exits = bvec3(t.x == tExit, t.x != tExit && t.y == tExit, t.x != tExit && t.y != tExit);
    ivec3 inside = clamp(ivec3(floor(g.origin + g.direction * tExit)), lo, hi);
    ivec3 beyond = mix(lo - 1, hi + 1, g.positive);
    return mix(inside, beyond, exits);
}

Hit intersectList(Ray ray, uint offset, Hit best, inout WorkCounters work) {
    uint end = offset + loadReference(offset);
    if (kCountWork) work.tests += end - offset;
    for (uint i = offset + 1u; i <= end; ++i) best = intersectTriangle(ray, loadTriangle(loadReference(i)), best);
    return best;
}

// `ray` starts in the grid, or so little before it that its first voxel is at the border. anyHit: returns the first hit that is found.
Hit walkGrid(Ray ray, bool anyHit, inout WorkCounters work) {
    GridRay g = toGridRay(ray);
    ivec3 last = ivec3(grid.dims.xyz) - 1;
    float tStart = max(ray.tMin, 0.0f) * (1.0f - 2.0f * gammaBound(3.0f));
    ivec3 cell = clamp(ivec3(floor(g.origin + g.direction * tStart)), ivec3(0), last);
    Hit best = Hit(ray.tMax, 0.0f, 0.0f, kNoTriangle);
    for (;;) {
        if (kCountWork) work.steps += 1u;
        uint word = loadVoxel(cell);
        int reach = 0;
        if (word >= kOccupiedBit) {
            best = intersectList(ray, word & ~kOccupiedBit, best, work);
            if (anyHit && best.triangle != kNoTriangle) return best;
        } else {
            reach = freeReach(word);
        }
        float tExit;
        cell = nextVoxel(g, cell, reach, tExit);
        // A triangle may be hit beyond its voxel; the hit stands unless a nearer one can still come.
        if (tExit > best.t * (1.0f + 2.0f * gammaBound(3.0f))) return best;
        if (any(lessThan(cell, ivec3(0))) || any(greaterThan(cell, last))) return best;
    }
}

// Nearest hit of a ray with tMin <= t <= tMax (tMin >= 0), or with anyHit any such hit.
Hit trace(Ray ray, bool anyHit, inout WorkCounters work) {
    if (kCountWork) work.rays += 1u;
    ray.direction = withoutTinyComponents(ray.direction);
    Hit miss = Hit(ray.tMax, 0.0f, 0.0f, kNoTriangle);
    vec3 gridHi = grid.gridLo.xyz + vec3(grid.dims.xyz) * grid.cellSize.xyz;
    vec2 span = boxSpan(ray, grid.gridLo.xyz, gridHi);
    // Three roundings each: the entry is taken as early, the exit as late as it can be.
    float tEnter = max(span.x * (1.0f - 2.0f * gammaBound(3.0f)), 0.0f);
    float tLeave = span.y * (1.0f + 2.0f * gammaBound(3.0f));
    if (!(tEnter <= tLeave) || !(ray.tMin <= tLeave) || !(tEnter <= ray.tMax)) return miss;
    // From here on t counts from the grid's border, so that a far origin does not cost precision inside. One rounding,
    // with fma: the new origin lies on the ray, whatever the error of tEnter.
    vec3 origin = fma(ray.direction, vec3(tEnter), ray.origin);
    Ray base = Ray(origin, ray.direction, ray.tMin - tEnter, ray.tMax - tEnter);
    Hit hit = walkGrid(base, anyHit, work);
    if (hit.triangle == kNoTriangle) return miss;
    hit.t += tEnter;
    return hit;
}

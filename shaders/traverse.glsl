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
vec2 boxSpan(vec3 origin, vec3 direction, vec3 lo, vec3 hi) {
    bvec3 still = equal(direction, vec3(0.0f));
    vec3 inverse = 1.0f / direction;
    vec3 a = (lo - origin) * inverse;
    vec3 b = (hi - origin) * inverse;
    bvec3 outside = bvec3(uvec3(lessThan(origin, lo)) | uvec3(greaterThan(origin, hi)));
    vec3 near = mix(min(a, b), mix(vec3(-kNever), vec3(kNever), outside), still);
    vec3 far = mix(max(a, b), vec3(kNever), still);
    return vec2(max(near.x, max(near.y, near.z)), min(far.x, min(far.y, far.z)));
}

// `base` is the ray moved to where it enters the grid.
GridRay toGridRay(Ray base) {
    GridRay g;
    g.origin = (base.origin - grid.gridLo.xyz) * grid.cellsPerUnit.xyz;
    g.direction = base.direction * grid.cellsPerUnit.xyz;
    // A component that cannot move the ray by a millionth of a voxel on its way through the grid counts as 0: its
    // inverse would overflow.
    vec3 size = abs(g.direction);
    float largest = max(size.x, max(size.y, size.z));
    bvec3 still = lessThan(size, vec3(largest * 1e-12f));
    g.direction = mix(g.direction, vec3(0.0f), still);
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

// `ray` starts in the grid. anyHit: returns the first hit that is found.
Hit walkGrid(Ray ray, bool anyHit, inout WorkCounters work) {
    GridRay g = toGridRay(ray);
    ivec3 last = ivec3(grid.dims.xyz) - 1;
    ivec3 cell = clamp(ivec3(floor(g.origin + g.direction * max(ray.tMin, 0.0f))), ivec3(0), last);
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

// Nearest hit of a ray with tMin <= t <= tMax, or with anyHit any such hit.
Hit trace(Ray ray, bool anyHit, inout WorkCounters work) {
    if (kCountWork) work.rays += 1u;
    Hit miss = Hit(ray.tMax, 0.0f, 0.0f, kNoTriangle);
    vec3 gridHi = grid.gridLo.xyz + vec3(grid.dims.xyz) * grid.cellSize.xyz;
    vec2 span = boxSpan(ray.origin, ray.direction, grid.gridLo.xyz, gridHi);
    float tEnter = max(span.x, 0.0f);
    if (!(tEnter <= span.y * (1.0f + 2.0f * gammaBound(3.0f))) || !(ray.tMin <= span.y) || !(tEnter <= ray.tMax)) return miss;
    // From here on t counts from the grid's border, so that a far origin does not cost precision inside.
    Ray base = Ray(ray.origin + ray.direction * tEnter, ray.direction, ray.tMin - tEnter, ray.tMax - tEnter);
    Hit hit = walkGrid(base, anyHit, work);
    if (hit.triangle == kNoTriangle) return miss;
    hit.t += tEnter;
    return hit;
}

// Walks a ray through the voxel grid (Amanatides & Woo 1987), leaping over empty space as far as the voxel's proximity
// value (Cohen & Sheffer 1994) or empty box allows, and into bricks of finer voxels. Numerics: shaders/README.md.

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

// Voxels are at most 2^finestLevel() times smaller than those of level 0.
int finestLevel() {
    if (kStructure != kStructureNested) return 0;
    uint longest = max(grid.dims.x, max(grid.dims.y, grid.dims.z));
    return findMSB(kMaxFinestSide) - 1 - findMSB(longest - 1u); // findMSB(0) is -1
}

// `base` is the ray moved to where it enters the grid.
GridRay toGridRay(Ray base) {
    GridRay g;
    g.origin = (base.origin - grid.gridLo.xyz) * grid.cellsPerUnit.xyz;
    g.direction = base.direction * grid.cellsPerUnit.xyz;
    bvec3 still = equal(g.direction, vec3(0.0f));
    g.inverse = mix(1.0f / g.direction, vec3(kNever), still);
    // Keeps a ray that runs inside a voxel face in the middle of its voxels, the finest that there may be, where no exit
    // plane is 0 away.
    float fine = powerOfTwo(finestLevel());
    vec3 middle = (floor(clamp(g.origin * fine, vec3(0.0f), vec3(grid.dims.xyz) * fine - 1.0f)) + 0.5f) / fine;
    g.origin = mix(g.origin, middle, still);
    g.positive = greaterThanEqual(g.direction, vec3(0.0f));
    return g;
}

// A voxel whose side is 2^-level of that of a voxel of the grid; `cell` counts in voxels of this size. Where there are no
// bricks the level is 0 at compile time.
struct Voxel {
    ivec3 cell;
    int level;
};

#if RT_STRUCTURE == 3 // kStructureNested: loadBrick() exists
// The word of the empty voxel or leaf in which the ray is at distance t, having just entered `voxel`; `voxel` becomes
// that voxel. The entered one may be finer than what is there, or coarser: then the position decides.
uint descend(GridRay g, float t, inout Voxel voxel) {
    Voxel entered = voxel;
    voxel = Voxel(entered.cell >> entered.level, 0);
    uint word = loadVoxel(voxel.cell);
    while (isBrick(word)) {
        int shift = brickShift(word);
        voxel.level += shift;
        int finer = voxel.level - entered.level;
        if (finer <= 0) {
            voxel.cell = entered.cell >> -finer;
        } else {
            ivec3 lo = entered.cell << finer;
            ivec3 at = ivec3(floor((g.origin + g.direction * t) * powerOfTwo(voxel.level)));
            voxel.cell = clamp(at, lo, lo + ((1 << finer) - 1));
        }
        ivec3 inBrick = voxel.cell & ((1 << shift) - 1);
        word = loadBrick(brickOffset(word) + uint((((inBrick.z << shift) + inBrick.y) << shift) + inBrick.x));
    }
    return word;
}
#else
uint descend(GridRay g, float t, inout Voxel voxel) {
    return loadVoxel(voxel.cell);
}
#endif

// The box of voxels round one, of its size, that the ray may leave in one step: how many beyond it on each side.
struct Reach {
    ivec3 below;
    ivec3 above;
};

Reach freeReach(uint emptyWord) {
    if (kStructure == kStructureNested) return Reach(freeBelow(emptyWord), freeAbove(emptyWord));
    if (kStructure == kStructureCloud) return Reach(ivec3(int(emptyWord) - 1), ivec3(int(emptyWord) - 1));
    return Reach(ivec3(0), ivec3(0));
}

// The voxel, of the same level, behind the exit face of the box; tExit receives when the ray gets there.
Voxel nextVoxel(GridRay g, Voxel voxel, Reach reach, out float tExit) {
    ivec3 lo = voxel.cell - mix(reach.below, ivec3(0), g.positive); // never step back: rounding at a face would
    ivec3 hi = voxel.cell + mix(ivec3(0), reach.above, g.positive); // revisit this voxel for ever
    vec3 plane = mix(vec3(lo), vec3(hi + 1), g.positive) * powerOfTwo(-voxel.level);
    vec3 t = (plane - g.origin) * g.inverse;
    tExit = min(t.x, min(t.y, t.z));
    bvec3 exits = bvec3(t.x == tExit, t.x != tExit && t.y == tExit, t.x != tExit && t.y != tExit);
    vec3 position = (g.origin + g.direction * tExit) * powerOfTwo(voxel.level);
    ivec3 inside = clamp(ivec3(floor(position)), lo, hi);
    ivec3 beyond = mix(lo - 1, hi + 1, g.positive);
    return Voxel(mix(inside, beyond, exits), voxel.level);
}

bool isInGrid(Voxel voxel) {
    ivec3 end = ivec3(grid.dims.xyz) << voxel.level;
    return all(greaterThanEqual(voxel.cell, ivec3(0))) && all(lessThan(voxel.cell, end));
}

struct ListPlace {
    uint first; // triangle
    uint end;
};

// Where the list of an occupied voxel stands; `exitReach` is the box that may be left once it is tested.
ListPlace listOf(uint word, out Reach exitReach) {
    uint header = kStructure == kStructureNested ? leafList(word) : word & ~kOccupiedBit;
    exitReach = Reach(ivec3(0), ivec3(0));
    if (kStructure == kStructureNested) exitReach = freeReach(loadReference(header++));
    return ListPlace(header + 1u, header + 1u + loadReference(header));
}

Hit intersectList(Ray ray, ListPlace list, Hit best, inout WorkCounters work) {
    if (kCountWork) work.tests += list.end - list.first;
    for (uint i = list.first; i < list.end; ++i) best = intersectTriangle(ray, loadTriangle(loadReference(i)), best);
    return best;
}

// `ray` starts in the grid, or so little before it that its first voxel is at the border. anyHit: returns the first hit that is found.
Hit walkGrid(Ray ray, bool anyHit, inout WorkCounters work) {
    GridRay g = toGridRay(ray);
    ivec3 last = ivec3(grid.dims.xyz) - 1;
    float t = max(ray.tMin, 0.0f) * (1.0f - 2.0f * gammaBound(3.0f));
    Voxel voxel = Voxel(clamp(ivec3(floor(g.origin + g.direction * t)), ivec3(0), last), 0);
    Hit best = Hit(ray.tMax, 0.0f, 0.0f, kNoTriangle);
    for (;;) {
        if (kCountWork) work.steps += 1u;
        uint word = descend(g, t, voxel);
        Reach reach;
        if (word >= kOccupiedBit) {
            best = intersectList(ray, listOf(word, reach), best, work);
            if (anyHit && best.triangle != kNoTriangle) return best;
        } else {
            reach = freeReach(word);
        }
        voxel = nextVoxel(g, voxel, reach, t);
        // A triangle may be hit beyond its voxel; the hit stands unless a nearer one can still come.
        if (t > best.t * (1.0f + 2.0f * gammaBound(3.0f)) || !isInGrid(voxel)) return best;
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

// Walks a ray through the voxel grid (Amanatides & Woo 1987), leaping over empty space as far as the voxel's proximity
// value (Cohen & Sheffer 1994) or empty box allows, and into bricks of finer voxels. Numerics: shaders/README.md.

const real kNever = 1e30f;

// A ray in the grid. Coordinates count the finest voxels that there may be, and each axis along which the ray runs
// backwards is turned round, so that all directions are >= 0: x' = mirrorSide() - x. position = origin + t * direction.
struct GridRay {
    real3 origin;
    real3 direction;
    real3 inverse; // 1 / direction; kNever where the direction is 0
    ivec3 toVoxel; // bits to flip in a place for its voxel
};

// A place is a voxel's whole coordinate as the bits of the float 2^23 + coordinate: a float becomes a place, and back, by an
// addition, where conversions take a GPU several times as long. Places can be compared, added to and shifted like numbers; those in
// the grid are below 2^23, and behind it they only have to stay behind it. In double precision they are plain numbers.
#if RT_DOUBLE
const int kPlaceZero = 0;
ivec3 placeAt(real3 position) {
    return ivec3(floor(position));
}
real3 positionOf(ivec3 place) {
    return real3(place);
}
#else
const int kPlaceZero = 0x4B000000; // bits of 2^23
// position - 0.5, rounded to the nearest whole number, is the voxel, on its face the one on either side; below 0.25 it may come out
// before the first voxel, so callers clamp it.
ivec3 placeAt(real3 position) {
    precise real3 shifted = position + 8388607.5f;
    return floatBitsToInt(shifted);
}
real3 positionOf(ivec3 place) {
    precise real3 position = intBitsToFloat(place) - 8388608.0f;
    return position;
}
#endif

// Distance at which the ray enters the box [lo, hi] (x) and leaves it (y); x > y if it misses.
real2 boxSpan(Ray ray, real3 lo, real3 hi) {
    bvec3 still = equal(ray.direction, real3(0.0f));
    real3 inverse = 1.0f / ray.direction;
    real3 a = (lo - ray.origin) * inverse;
    real3 b = (hi - ray.origin) * inverse;
    bvec3 outside = bvec3(uvec3(lessThan(ray.origin, lo)) | uvec3(greaterThan(ray.origin, hi)));
    real3 near = mix(min(a, b), mix(real3(-kNever), real3(kNever), outside), still);
    real3 far = mix(max(a, b), real3(kNever), still);
    return real2(max(near.x, max(near.y, near.z)), min(far.x, min(far.y, far.z)));
}

// A component that is nothing beside the largest one becomes 0: its inverse would overflow, and even from 10^9 scene
// sizes away it cannot move the ray by a rounding error.
real3 withoutTinyComponents(real3 direction) {
    real3 size = abs(direction);
    real largest = max(size.x, max(size.y, size.z));
    return mix(direction, real3(0.0f), lessThan(size, real3(largest * 1e-20f)));
}

uint longestSide() {
    return max(grid.dims.x, max(grid.dims.y, grid.dims.z));
}

// A voxel of the grid is 2^finestLevel() of the finest voxels wide.
int finestLevel() {
    if (kStructure != kStructureNested) return 0;
    return finestLevelOf(longestSide());
}

// A power of two, so that turning round a voxel's coordinate is flipping its bits; at least the grid's longest side, and 16
// for freeAhead().
int mirrorSide() {
    if (kStructure == kStructureNested) return int(kMaxFinestSide);
    return 1 << max(findMSB(longestSide() - 1u) + 1, 4);
}

// `base` is the ray moved to where it enters the grid.
GridRay toGridRay(Ray base) {
    GridRay g;
    real fine = powerOfTwo(finestLevel());
    real3 size = real3(grid.dims.xyz) * fine;
    real3 origin = (base.origin - grid.gridLo.xyz) * (grid.cellsPerUnit.xyz * fine);
    real3 direction = base.direction * (grid.cellsPerUnit.xyz * fine);
    bvec3 still = equal(direction, real3(0.0f));
    bvec3 backwards = lessThan(direction, real3(0.0f));
    // A ray that runs inside a voxel face is kept in the middle of its voxels, where no exit plane is 0 away.
    origin = mix(origin, floor(clamp(origin, real3(0.0f), size - 1.0f)) + 0.5f, still);
    g.origin = mix(origin, real(mirrorSide()) - origin, backwards);
    g.direction = abs(direction);
    g.inverse = mix(1.0f / g.direction, real3(kNever), still);
    g.toVoxel = mix(ivec3(kPlaceZero), ivec3(kPlaceZero + mirrorSide() - 1), backwards);
    return g;
}

// The place where the walk begins.
ivec3 firstPlace(GridRay g, real tMin) {
    real t = max(tMin, 0.0f) * (1.0f - 2.0f * gammaBound(3.0f));
    ivec3 size = ivec3(grid.dims.xyz) << finestLevel();
    ivec3 least = mix(ivec3(kPlaceZero), kPlaceZero + mirrorSide() - size, notEqual(g.toVoxel, ivec3(kPlaceZero)));
    return clamp(placeAt(fma(g.direction, real3(t), g.origin)), least, least + size - 1);
}

// The grid's voxel that the finest voxel is in; behind the grid, on an axis that is turned round too, a coordinate is too large.
ivec3 gridVoxel(ivec3 finest) {
    return finest >> finestLevel();
}

bool isInGrid(ivec3 gridVoxel) {
    return all(lessThan(uvec3(gridVoxel), grid.dims.xyz));
}

// The word of the empty voxel or leaf at the finest voxel `voxel`; it is 2^sizeShift of those wide.
uint lookUp(ivec3 voxel, out int sizeShift) {
    sizeShift = finestLevel();
    uint word = loadVoxel(gridVoxel(voxel));
#if RT_STRUCTURE == 3 // kStructureNested: loadBrick() exists
    while (isBrick(word)) {
        int shift = brickShift(word);
        sizeShift -= shift;
        ivec3 inBrick = (voxel >> sizeShift) & ((1 << shift) - 1);
        word = loadBrick(brickOffset(word) + uint((((inBrick.z << shift) + inBrick.y) << shift) + inBrick.x));
    }
#endif
    return word;
}

// How many voxels beyond this one, and of its size, the ray may leave in one step along each axis.
ivec3 freeAhead(GridRay g, uint emptyWord) {
    if (kStructure == kStructureUniform) return ivec3(0);
    if (kStructure == kStructureCloud) return ivec3(max(int(emptyWord), 1) - 1);
    // First bits of the extents to the sides that the ray runs to: 5, 15 and 25, or 0, 10 and 20 where the axis is turned.
    ivec3 first = ivec3(5, 15, 25) ^ (g.toVoxel & ivec3(5, 5, 13));
    return ivec3(emptyWord >> first.x, emptyWord >> first.y, emptyWord >> first.z) & 31;
}

// Moves the place `at` behind the exit face of the free box round its voxel; returns the distance at which the ray gets there.
real leap(GridRay g, uint emptyWord, int sizeShift, inout ivec3 at) {
    ivec3 end = ((at >> sizeShift) + freeAhead(g, emptyWord) + 1) << sizeShift;
    real3 exits = (positionOf(end) - g.origin) * g.inverse;
    real t = min(exits.x, min(exits.y, exits.z));
    // Never back, never out of the box but through its exit face, or faces: rounding must not revisit a voxel for ever.
    ivec3 inside = min(max(placeAt(fma(g.direction, real3(t), g.origin)), at), end - 1);
    at = mix(inside, end, equal(exits, real3(t)));
    return t;
}

// Whether a walk that has come to the finest voxel `voxel` at distance t is over. A triangle may be hit beyond its voxel; the
// hit stands unless a nearer one can still come.
bool endsAt(real t, ivec3 voxel, Hit best) {
    return t > best.t * (1.0f + 2.0f * gammaBound(3.0f)) || !isInGrid(gridVoxel(voxel));
}

// Set where a walk was ended by the device, which some do after a number of rounds, and not by itself.
bool walkCutShort = false;

// Tests a leaf's list. Returns the word that then holds for its voxel as for an empty one.
uint intersectList(Ray ray, RayShear shear, uint leaf, inout Hit best, inout WorkCounters work) {
    uint at = leafList(leaf);
    uint exitBox = loadReference(at);
    uint entry = loadReference(++at);
    for (;;) {
        uint next = loadReference(++at); // asked for before the test, which does not wait for it then; after the last, the next list
        if (kCountWork) work.tests += 1u;
        best = intersectEntry(ray, shear, entry & ~kLastInList, best);
        if (entry >= kLastInList) break;
        entry = next;
    }
    if (kSoftware && entry < kLastInList) walkCutShort = true;
    return exitBox;
}

// `ray` starts in the grid, or so little before it that its first voxel is at the border. anyHit: returns the first hit that is found.
Hit walkGrid(Ray ray, bool anyHit, inout WorkCounters work) {
    GridRay g = toGridRay(ray);
    RayShear shear = shearAlong(ray.direction);
    ivec3 at = firstPlace(g, ray.tMin);
    ivec3 voxel = at ^ g.toVoxel;
    Hit best = Hit(ray.tMax, 0.0f, 0.0f, kNoTriangle);
    bool over = false;
    for (;;) {
        if (kCountWork) work.steps += 1u;
        int sizeShift;
        uint word = lookUp(voxel, sizeShift);
        if (word >= kOccupiedBit) {
            word = intersectList(ray, shear, word, best, work);
            if (anyHit && best.triangle != kNoTriangle) {
                if (kSoftware) over = true;
                break;
            }
        }
        real t = leap(g, word, sizeShift, at);
        voxel = at ^ g.toVoxel;
        if (endsAt(t, voxel, best)) {
            if (kSoftware) over = true;
            break;
        }
    }
    if (kSoftware && !over) walkCutShort = true;
    return best; // the only way out: with returns in the loop a driver lost 5 to 20 % of the speed
}

// origin + direction * t with one rounding.
#if RT_SOFTWARE
real3 moveAlong(real3 origin, real3 direction, real t) { // Dekker 1971
    precise real3 shifted = direction * kSplitter;
    precise real3 high = shifted - (shifted - direction);
    precise real3 low = direction - high;
    precise real shiftedT = t * kSplitter;
    precise real highT = shiftedT - (shiftedT - t);
    precise real lowT = t - highT;
    precise real3 product = direction * t;
    precise real3 productRest = low * lowT - (((product - high * highT) - low * highT) - high * lowT);
    precise real3 sum = origin + product;
    precise real3 added = sum - origin;
    precise real3 sumRest = (origin - (sum - added)) + (product - added);
    precise real3 moved = sum + (sumRest + productRest);
    return moved;
}
#else
real3 moveAlong(real3 origin, real3 direction, real t) {
    return fma(direction, real3(t), origin);
}
#endif

// The time from the border on that is the last (sign 1) or first (sign -1) to give, with tEnter added and rounded, no more (no
// less) than `limit`, which is > 0: so a ray may begin or end where a hit is said to be.
real limitFromEntry(real limit, real tEnter, real sign) {
    const real kStep = 1.2f * kRoundoff; // of a number: to its neighbour
    precise real next = limit + limit * kStep * sign;
    precise real t = (limit - tEnter) + 0.5f * (next - limit);
    // That has two roundings.
    precise real farther = t + abs(t) * kStep * sign;
    precise real nearer = t - abs(t) * kStep * sign;
    precise real atFarther = farther + tEnter;
    precise real atT = t + tEnter;
    if (atFarther * sign <= limit * sign) return farther;
    return atT * sign <= limit * sign ? t : nearer;
}

const real kFarAway = 16.0f; // from where on the entry time is off by voxels; directions and the grid are about unit size
const real kBeyondScenes = 1e20f; // where no scene is any more

// Moves the ray's origin to where it enters the grid, at distance tEnter; false if it misses the grid. From there on t counts
// from the grid's border, so that a far origin does not cost precision inside.
bool enterGrid(inout Ray ray, out real tEnter) {
    ray.direction = withoutTinyComponents(ray.direction);
    real3 gridHi = grid.gridLo.xyz + real3(grid.dims.xyz) * grid.cellSize.xyz;
    real2 span = boxSpan(ray, grid.gridLo.xyz, gridHi);
    // Three roundings each: the entry is taken as early, the exit as late as it can be.
    tEnter = max(span.x * (1.0f - 2.0f * gammaBound(3.0f)), 0.0f);
    real tLeave = span.y * (1.0f + 2.0f * gammaBound(3.0f));
    bool enters = tEnter <= tLeave && ray.tMin <= tLeave && tEnter <= ray.tMax && tEnter < kNever;
    // The new origin lies on the ray, whatever the error of tEnter.
    ray.origin = moveAlong(ray.origin, ray.direction, tEnter);
    if (tEnter > kFarAway) { // that error may be many grids: a second step leads from there to the border
        real tNear = max(boxSpan(ray, grid.gridLo.xyz, gridHi).x * (1.0f - 2.0f * gammaBound(3.0f)), 0.0f);
        tNear = min(tNear, tEnter); // a ray that misses the grid has no such time
        ray.origin = moveAlong(ray.origin, ray.direction, tNear);
        tEnter += tNear;
    }
    bool isLimited = ray.tMin > 0.0f || ray.tMax < kBeyondScenes; // few are
    if (isLimited && tEnter > 0.0f) {
        ray.tMin = ray.tMin > 0.0f ? limitFromEntry(ray.tMin, tEnter, -1.0f) : -tEnter;
        ray.tMax = limitFromEntry(ray.tMax, tEnter, 1.0f);
    } else {
        ray.tMin -= tEnter;
        ray.tMax -= tEnter;
    }
    return enters;
}

// A hit of the walk, whose t counts from the grid's border, as one of the ray.
Hit hitOf(Ray ray, real tEnter, Hit inWalk) {
    if (inWalk.triangle == kNoTriangle) return Hit(ray.tMax, 0.0f, 0.0f, kNoTriangle);
    inWalk.t += tEnter;
    return inWalk;
}

// Nearest hit of a ray with tMin <= t <= tMax (tMin >= 0), or with anyHit any such hit.
Hit trace(Ray ray, bool anyHit, inout WorkCounters work) {
    if (kCountWork) work.rays += 1u;
    Ray inGrid = ray;
    real tEnter;
    if (!enterGrid(inGrid, tEnter)) return Hit(ray.tMax, 0.0f, 0.0f, kNoTriangle);
    return hitOf(ray, tEnter, walkGrid(inGrid, anyHit, work));
}

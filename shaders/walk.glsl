// walkGrid() of traverse.glsl in pieces, for lanes that walk side by side: each piece is short, so that lanes whose rays
// have much to do keep the others waiting for little.

// A ray on its way through the grid.
struct Walk {
    Ray ray;
    RayShear shear;
    GridRay g;
    ivec3 at; // a place, see traverse.glsl
    int sizeShift; // the voxel there is 2^sizeShift of those wide; -1: nobody has looked yet
    uint word; // of that voxel, as if it were empty
    uint entry; // of its list, to be tested next
    uint entryAt; // where the one after it is; 0: none is left
    bool walking;
    Hit best;
};

// `ray` as for walkGrid().
Walk beginWalk(Ray ray) {
    GridRay g = toGridRay(ray);
    return Walk(ray, shearAlong(ray.direction), g, firstPlace(g, ray.tMin), -1, 0u, 0u, 0u, true, Hit(ray.tMax, 0.0f, 0.0f, kNoTriangle));
}

// Leaves the voxel, whose list has been tested, and looks at the next one.
void stepOn(inout Walk w, inout WorkCounters work) {
    real t = w.sizeShift >= 0 ? leap(w.g, w.word, w.sizeShift, w.at) : 0.0f;
    ivec3 voxel = w.at ^ w.g.toVoxel;
    if (endsAt(t, voxel, w.best)) w.walking = false;
    if (!w.walking) return;
    if (kCountWork) work.steps += 1u;
    w.word = lookUp(voxel, w.sizeShift);
    if (w.word >= kOccupiedBit) {
        uint list = leafList(w.word);
        w.word = loadReference(list);
        w.entry = loadReference(list + 1u);
        w.entryAt = list + 2u;
    }
}

void testEntry(inout Walk w, bool anyHit, inout WorkCounters work) {
    uint next = loadReference(w.entryAt++); // asked for before the test, which does not wait for it then
    if (kCountWork) work.tests += 1u;
    w.best = intersectEntry(w.ray, w.shear, w.entry & ~kLastInList, w.best);
    if (w.entry >= kLastInList) w.entryAt = 0u;
    if (anyHit && w.best.triangle != kNoTriangle && w.entryAt == 0u) w.walking = false;
    w.entry = next;
}

// One step at most, two tests at most: lists have about two triangles for each step.
void advance(inout Walk w, bool anyHit, inout WorkCounters work) {
    if (w.walking && w.entryAt == 0u) stepOn(w, work);
    if (w.walking && w.entryAt != 0u) testEntry(w, anyHit, work);
    if (w.walking && w.entryAt != 0u) testEntry(w, anyHit, work);
}

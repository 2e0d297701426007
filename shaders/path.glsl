// Samples on their way: each has a slot in memory, where it waits between two rays. A dispatch traces one ray of every sample that
// has one, so that neighbouring lanes have work of the same kind (Laine, Karras & Aila 2013).

// Materials that a ray is in, the last entered first: four numbers of 16 bits. Where solids overlap or touch, the last
// one entered is the one that counts.
const uvec2 kNoMedia = uvec2(0xFFFFFFFFu);

// A ray that waits to be traced, and how much its light counts in the pixel.
struct Pending {
    real3 origin;
    real3 direction; // unit length
    vec3 weight;
    float width;   // of what the pixel covers, at the origin
    float density; // with which the direction was chosen, where lights are chosen too; else 0
    float gone;    // way since that choice: through what is clear it goes on
    uint depth;
    uint from; // triangle that it leaves; kNoTriangle at the eye
    uvec2 media;
};

// The next ray: one of a path, or to a light.
struct Flight {
    Ray ray; // tMin is 0
    bool shadow;
    bool anyHit;
    uint from; // triangle that it leaves, where that is counted
};

// Light on its way to a hit, along a shadow ray; what is clear tints it, without bending it.
struct Arriving {
    vec3 light;    // of the pixel
    vec3 straight; // more of it, if nothing bends it
    float left;    // at most, of what set out
    uint surfaces; // that it has come through
    uvec2 media;
};

const bool kTints = kHasTransmission || kHasOpacity;
const bool kManyJobs = uint(kHasOcclusion) + kLightCount + uint(kHasEnvironment) > 1u;

// The sample of this invocation.
uint slot;
Flight flight;
Pending path;       // the ray that looks for surfaces, or the last that did
Hit lit;            // what it met, while light is asked for there
uint job;           // the next light to ask for there
Arriving arriving;  // along the shadow ray
uint pendingCount;  // further rays, on the slot's stack
vec4 sampleColor;   // A: whether the first ray has hit something
vec3 sampleAlbedo;
WorkCounters work;

// Slots are spread over planes of four words each: see SlotLayout in tools/rt-trace/slot_layout.h.
uint placeIn(uint plane) {
    return plane * picture.slots.x + slot;
}
void storeWords(uint plane, uvec4 words) {
    slots[placeIn(plane)] = words;
}
uvec4 loadWords(uint plane) {
    return slots[placeIn(plane)];
}

#if RT_DOUBLE
void storePoint(uint plane, real3 v, uint word) {
    storeWords(plane, uvec4(unpackDouble2x32(v.x), unpackDouble2x32(v.y)));
    storeWords(plane + 1u, uvec4(unpackDouble2x32(v.z), word, 0u));
}
real3 loadPoint(uint plane, out uint word) {
    uvec4 xy = loadWords(plane), z = loadWords(plane + 1u);
    word = z.z;
    return real3(packDouble2x32(xy.xy), packDouble2x32(xy.zw), packDouble2x32(z.xy));
}
#else
void storePoint(uint plane, real3 v, uint word) {
    storeWords(plane, uvec4(floatBitsToUint(v), word));
}
real3 loadPoint(uint plane, out uint word) {
    uvec4 words = loadWords(plane);
    word = words.w;
    return uintBitsToFloat(words.xyz);
}
#endif

void storePending(uint level, Pending p) {
    uint plane = kPlaneStack + level * (2u * kPointPlanes + 2u);
    storePoint(plane, p.origin, p.from);
    storePoint(plane + kPointPlanes, p.direction, p.depth);
    storeWords(plane + 2u * kPointPlanes, floatBitsToUint(vec4(p.weight, p.width)));
    storeWords(plane + 2u * kPointPlanes + 1u, uvec4(floatBitsToUint(vec2(p.density, p.gone)), p.media));
}
Pending loadPending(uint level) {
    uint plane = kPlaneStack + level * (2u * kPointPlanes + 2u);
    Pending p;
    p.origin = loadPoint(plane, p.from);
    p.direction = loadPoint(plane + kPointPlanes, p.depth);
    vec4 seen = uintBitsToFloat(loadWords(plane + 2u * kPointPlanes));
    uvec4 rest = loadWords(plane + 2u * kPointPlanes + 1u);
    p.weight = seen.xyz;
    p.width = seen.w;
    p.density = uintBitsToFloat(rest.x);
    p.gone = uintBitsToFloat(rest.y);
    p.media = rest.zw;
    return p;
}

void storePath() {
    storeWords(kPlanePath, floatBitsToUint(vec4(path.weight, path.width)));
    storeWords(kPlanePath + 1u, uvec4(floatBitsToUint(vec2(path.density, path.gone)), path.media));
}
void loadPath() {
    vec4 seen = uintBitsToFloat(loadWords(kPlanePath));
    uvec4 rest = loadWords(kPlanePath + 1u);
    path.weight = seen.xyz;
    path.width = seen.w;
    path.density = uintBitsToFloat(rest.x);
    path.gone = uintBitsToFloat(rest.y);
    path.media = rest.zw;
}

void storeArriving() {
    storeWords(kPlaneArriving, floatBitsToUint(vec4(arriving.light, arriving.left)));
    if (!kTints) return;
    storeWords(kPlaneArriving + 1u, uvec4(floatBitsToUint(arriving.straight), arriving.surfaces));
    storeWords(kPlaneArriving + 2u, uvec4(arriving.media, 0u, 0u));
}
void loadArriving() {
    vec4 light = uintBitsToFloat(loadWords(kPlaneArriving));
    arriving = Arriving(light.xyz, vec3(0.0f), light.w, 0u, kNoMedia);
    if (!kTints) return;
    uvec4 straight = loadWords(kPlaneArriving + 1u);
    arriving.straight = uintBitsToFloat(straight.xyz);
    arriving.surfaces = straight.w;
    arriving.media = loadWords(kPlaneArriving + 2u).xy;
}

// The hit whose lights are asked for one after the other.
void storeLit() {
    storePoint(kPlaneLit, path.origin, job);
    storePoint(kPlaneLit + kPointPlanes, path.direction, lit.triangle);
    storePoint(kPlaneLit + 2u * kPointPlanes, real3(lit.t, lit.u, lit.v), 0u);
}
void loadLit() {
    uint unused;
    path.origin = loadPoint(kPlaneLit, job);
    path.direction = loadPoint(kPlaneLit + kPointPlanes, lit.triangle);
    real3 tuv = loadPoint(kPlaneLit + 2u * kPointPlanes, unused);
    lit.t = tuv.x;
    lit.u = tuv.y;
    lit.v = tuv.z;
}

void storeSample() {
    storeWords(kPlaneColor, floatBitsToUint(sampleColor));
    if (kHasAovs) storeWords(kPlaneAlbedo, floatBitsToUint(vec4(sampleAlbedo, 0.0f)));
    if (kCountWork) storeWords(kPlaneWork, uvec4(work.rays, work.steps, work.tests, work.selfHits));
}
void loadSample() {
    sampleColor = uintBitsToFloat(loadWords(kPlaneColor));
    if (kHasAovs) sampleAlbedo = uintBitsToFloat(loadWords(kPlaneAlbedo)).rgb;
    if (!kCountWork) return;
    uvec4 counted = loadWords(kPlaneWork);
    work = WorkCounters(work.rays + counted.x, work.steps + counted.y, work.tests + counted.z, work.selfHits + counted.w);
}

void storeFlight() {
    uint bits = uint(flight.shadow) | uint(flight.anyHit) << 1 | path.depth << 8 | pendingCount << 16;
    storePoint(kPlaneFlight, flight.ray.origin, floatBitsToUint(float(flight.ray.tMax)));
    storePoint(kPlaneFlight + kPointPlanes, flight.ray.direction, bits);
    if (kCountWork) storeWords(kPlaneWork + 1u, uvec4(flight.from, 0u, 0u, 0u));
}
void loadFlight() {
    uint tMax, bits;
    real3 origin = loadPoint(kPlaneFlight, tMax);
    real3 direction = loadPoint(kPlaneFlight + kPointPlanes, bits);
    flight = Flight(Ray(origin, direction, 0.0f, real(uintBitsToFloat(tMax))), (bits & 1u) != 0u, (bits & 2u) != 0u, kNoTriangle);
    path.depth = (bits >> 8) & 0xFFu;
    pendingCount = (bits >> 16) & 0xFFFFu;
    if (kCountWork) flight.from = loadWords(kPlaneWork + 1u).x;
}

// What a sample needs beyond its flight once that is over.
void storeState() {
    storeSample();
    if (flight.shadow) storeArriving();
    if (!flight.shadow || kManyJobs) storePath();
    if (flight.shadow && kManyJobs) storeLit();
}
void loadState() {
    loadSample();
    job = 0xFFFFFFFFu;
    if (flight.shadow) loadArriving();
    if (!flight.shadow || kManyJobs) loadPath();
    path.origin = flight.ray.origin;
    path.direction = flight.ray.direction;
    if (flight.shadow && kManyJobs) loadLit();
}

// Work groups whose first place is among `count` from `first` on.
uint groupsBegun(uint first, uint count) {
    const uint kSize = uint(RT_GROUP_X);
    return (first + count + kSize - 1u) / kSize - (first + kSize - 1u) / kSize;
}

// The queue of the next round takes this slot: paths from its front, shadow rays from its end. All that go on call this together.
void enqueue() {
    uint next = roundInGroup + 1u, queueStart = (next & 1u) * picture.slots.x;
    uint paths = lanesWhere(!flight.shadow), shadows = lanesWhere(flight.shadow);
    uvec2 rank = uvec2(rankWhere(!flight.shadow), rankWhere(flight.shadow));
    uvec2 first = uvec2(0u);
    if (isFirstLane()) {
        first.x = paths > 0u ? atomicAdd(rounds[next].counts.x, paths) : 0u;
        first.y = shadows > 0u ? atomicAdd(rounds[next].counts.y, shadows) : 0u;
        uint groups = groupsBegun(first.x, paths) + groupsBegun(first.y, shadows);
        if (groups > 0u) atomicAdd(rounds[next].groups.x, groups);
    }
    first = uvec2(fromFirstLane(first.x), fromFirstLane(first.y));
    queue[queueStart + (flight.shadow ? picture.slots.x - 1u - (first.y + rank.y) : first.x + rank.x)] = slot;
}

// False where the round has no sample for this invocation.
bool takeFromQueue() {
    uvec4 counts = rounds[roundInGroup].counts;
    uint pathGroups = (counts.x + RT_GROUP_X - 1u) / RT_GROUP_X;
    bool ofPath = gl_WorkGroupID.x < pathGroups;
    uint i = (gl_WorkGroupID.x - (ofPath ? 0u : pathGroups)) * RT_GROUP_X + gl_LocalInvocationID.x;
    if (i >= (ofPath ? counts.x : counts.y)) return false;
    slot = queue[(roundInGroup & 1u) * picture.slots.x + (ofPath ? i : picture.slots.x - 1u - i)];
    return true;
}

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

// Part of the way to a light that shadow rays go: a light may lie in a surface, such as a ceiling, and still shine.
const real kBeforeLight = 1.0f - 1e-4f;

const bool kTints = kHasTransmission || kHasOpacity;
const bool kManyJobs = uint(kHasOcclusion) + kLightCount + uint(kHasEnvironment) > 1u;

// The sample of this invocation.
uint sampleNumber; // in the batch: where its result is
uint slot;         // where it waits, once its first ray is traced
Flight flight;
Pending path;       // the ray that looks for surfaces, or the last that did
Hit lit;            // what it met, while light is asked for there
uint job;           // the next light to ask for there
Arriving arriving;  // along the shadow ray
uint pendingCount;  // further rays, on the slot's stack
vec4 sampleColor;   // A: whether the first ray has hit something
vec3 sampleAlbedo;

// Words stand as SlotLayout in tools/rt-trace/slot_layout.h says: results one plane after the other, as neighbouring lanes read
// them; all else in one record for each slot, as only one lane asks for it.
uint placeIn(uint plane) {
    uint results = kResultPlanes * picture.slots.x;
    return plane < kResultPlanes ? plane * picture.slots.x + sampleNumber : results + slot * kRecordPlanes + (plane - kResultPlanes);
}
// In slots.glsl, or where some planes are textures in pass.glsl.
void storeWords(uint plane, uvec4 words);
uvec4 loadWords(uint plane);

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

// What the sample's ray has met.
void storeHit(bool first, Hit hit) {
    storePoint(first ? kPlaneFirstHit : kPlaneHit, real3(hit.t, hit.u, hit.v), hit.triangle);
}
Hit loadHit(bool first) {
    uint triangle;
    real3 tuv = loadPoint(first ? kPlaneFirstHit : kPlaneHit, triangle);
    return Hit(tuv.x, tuv.y, tuv.z, triangle);
}

void storeSample() {
    storeWords(kPlaneColor, floatBitsToUint(sampleColor));
    if (kHasAovs) storeWords(kPlaneAlbedo, floatBitsToUint(vec4(sampleAlbedo, 0.0f)));
}
void loadSample() {
    sampleColor = uintBitsToFloat(loadWords(kPlaneColor));
    if (kHasAovs) sampleAlbedo = uintBitsToFloat(loadWords(kPlaneAlbedo)).rgb;
}

// How far a flight goes, in two bits.
const uint kEndless = 0u, kToLight = 1u, kNearby = 2u;

void storeFlight() {
    uint reach = flight.ray.tMax >= kUnlimited ? kEndless : flight.ray.tMax == kBeforeLight ? kToLight : kNearby;
    uint bits = uint(flight.shadow) | uint(flight.anyHit) << 1 | reach << 2 | path.depth << 8 | pendingCount << 16;
    storePoint(kPlaneFlight, flight.ray.origin, sampleNumber);
    storePoint(kPlaneFlight + kPointPlanes, flight.ray.direction, bits);
    if (kCountWork) storeWords(kPlaneWork + 1u, uvec4(flight.from, 0u, 0u, 0u));
}
void loadFlight() {
    uint bits;
    real3 origin = loadPoint(kPlaneFlight, sampleNumber);
    real3 direction = loadPoint(kPlaneFlight + kPointPlanes, bits);
    uint reach = (bits >> 2) & 3u;
    real tMax = reach == kEndless ? kUnlimited : reach == kToLight ? kBeforeLight : real(picture.ambient.w);
    flight = Flight(Ray(origin, direction, 0.0f, tMax), (bits & 1u) != 0u, (bits & 2u) != 0u, kNoTriangle);
    path.depth = (bits >> 8) & 0xFFu;
    pendingCount = (bits >> 16) & 0xFFFFu;
    if (kCountWork) flight.from = loadWords(kPlaneWork + 1u).x;
}

void countWork(bool first, WorkCounters work) {
    uvec4 before = first ? uvec4(0u) : loadWords(kPlaneWork);
    storeWords(kPlaneWork, before + uvec4(work.rays, work.steps, work.tests, work.selfHits));
}

// What a sample needs beyond its flight once that is over.
void storeState() {
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

// Ticks of the device's clock that a sample takes, those of lanes beside it in part.
#if RT_HAS_TIME
#define Clock uvec2
Clock readClock() {
    return clock2x32ARB();
}
void addTime(Clock begun, bool first) {
    Clock now = clock2x32ARB();
    uint borrow;
    uint low = usubBorrow(now.x, begun.x, borrow);
    float ticks = 4294967296.0f * float(now.y - begun.y - borrow) + float(low);
    if (!first) ticks += uintBitsToFloat(loadWords(kPlaneTime).x);
    storeWords(kPlaneTime, uvec4(floatBitsToUint(ticks), 0u, 0u, 0u));
}
#else
#define Clock uint
Clock readClock() {
    return 0u;
}
void addTime(Clock begun, bool first) {}
#endif

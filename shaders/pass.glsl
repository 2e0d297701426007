// One ray of each pixel on its way, in textures with a texel for each pixel. Passes over all pixels change them in place: a fragment
// reads only its own texel, and writes it once or discards itself.

ivec2 texel;

void findTexel() {
    texel = ivec2(gl_FragCoord.xy);
    uvec2 inRegion = uvec2(texel) + picture.size.zw - picture.region.xy;
    sampleNumber = inRegion.y * (picture.region.z - picture.region.x) + inRegion.x;
    slot = sampleNumber;
}
Place placeOfTexel() {
    return Place(uvec2(texel) + picture.size.zw, picture.samples.x);
}

// What a pass has for its targets.
uvec4 colorWords, originWords, directionWords, hitWords;

void storeWords(uint plane, uvec4 words) {
    if (plane == kPlaneColor) colorWords = words;
    else if (plane == kPlaneFlight) originWords = words;
    else if (plane == kPlaneFlight + 1u) directionWords = words;
    else if (plane == kPlaneHit) hitWords = words;
    else slots[placeIn(plane)] = words;
}
uvec4 loadWords(uint plane) {
    if (plane == kPlaneColor) return texelFetch(colorTexture, texel, 0);
    if (plane == kPlaneFlight) return texelFetch(originTexture, texel, 0);
    if (plane == kPlaneFlight + 1u) return texelFetch(directionTexture, texel, 0);
    if (plane == kPlaneHit) return texelFetch(hitTexture, texel, 0);
    return slots[placeIn(plane)];
}

const uint kEnded = 0u;   // the pixel has no ray any more
const uint kBegun = 1u;   // the ray is in its first voxel, the hit texture holds nothing of it yet
const uint kWalking = 2u; // it is in another one
const uint kLanded = 3u;  // its walk is over, the hit texture says with what
const uint kOutside = 4u; // it never enters the grid
const uint kResting = 5u; // ended, and the pixel's depth says so

// How far a ray has come.
struct Progress {
    uint phase;
    ivec3 at;      // a place, see traverse.glsl
    int sizeShift; // of the voxel there, see lookUp()
    uint word;     // of that voxel
};

const uint kPlaceBits = 24u; // places in the grid have 23 beside kPlaceZero

Progress loadProgress() {
    uvec4 words = texelFetch(progressTexture, texel, 0);
    uvec3 above = words.xyz >> kPlaceBits;
    return Progress(above.x, ivec3(words.xyz & ((1u << kPlaceBits) - 1u)) + kPlaceZero, int(above.y), words.w);
}
uvec4 wordsOf(Progress p) {
    return uvec4(uvec3(p.at - kPlaceZero) | uvec3(p.phase, p.sizeShift, 0u) << kPlaceBits, p.word);
}

bool isUnderWay(Progress p) {
    return p.phase == kBegun || p.phase == kWalking;
}

Progress beginProgress(Ray ray) {
    real tEnter;
    if (!enterGrid(ray, tEnter)) return Progress(kOutside, ivec3(kPlaceZero), 0, 0u);
    GridRay g = toGridRay(ray);
    ivec3 at = firstPlace(g, ray.tMin);
    int sizeShift;
    uint word = lookUp(at ^ g.toVoxel, sizeShift);
    return Progress(kBegun, at, sizeShift, word);
}

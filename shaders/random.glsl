// Numbers in [0, 1) for each sample of each pixel: a Sobol sequence, Owen-scrambled by hashing (Laine & Karras 2011, Burley 2020).
// Every decision takes a pair of its own; over a pixel's samples each pair is spread evenly.

struct Sampler {
    uint seed;  // of the pixel
    uint index; // of the sample
};

uint hashed(uint x) {
    x ^= x >> 16;
    x *= 0x21F0AAADu;
    x ^= x >> 15;
    x *= 0xD35A2D97u;
    return x ^ (x >> 15);
}

uint hashed(uint x, uint y) {
    return hashed(x ^ (hashed(y) + 0x9E3779B9u + (x << 6) + (x >> 2)));
}

Sampler samplerOf(uvec2 pixel, uint index) {
    return Sampler(hashed(hashed(pixel.x, pixel.y), picture.samples.z), index);
}

// Flips each bit by a hash of the bits above it.
uint scrambled(uint x, uint seed) {
    x = bitfieldReverse(x);
    x += seed;
    x ^= x * 0x6C50B47Cu;
    x ^= x * 0xB82F1E52u;
    x ^= x * 0xC7AFE638u;
    x ^= x * 0x8D22F6E6u;
    return bitfieldReverse(x);
}

uint sobolSecond(uint index) {
    uint result = 0u;
    for (uint direction = 0x80000000u; index != 0u; index >>= 1, direction ^= direction >> 1)
        if ((index & 1u) != 0u) result ^= direction;
    return result;
}

// What the pairs are for: those of a ray's hit are kPairsPerDepth further on for each reflection or refraction before it.
const uint kPairFilter = 0u;
const uint kPairLens = 1u;
const uint kPairFacet = 2u;
const uint kPairRoulette = 3u;
const uint kPairOcclusion = 4u;
const uint kPairEnvironment = 5u;
const uint kPairEnvironmentKind = 6u;
const uint kPairLights = 7u; // and on: one for each light
const uint kPairsPerDepth = 1024u;

vec2 pairOf(Sampler s, uint purpose, uint depth) {
    uint seed = hashed(s.seed, purpose + depth * kPairsPerDepth);
    uint index = scrambled(s.index, seed);
    uvec2 bits = uvec2(scrambled(bitfieldReverse(index), hashed(seed, 1u)), scrambled(sobolSecond(index), hashed(seed, 2u)));
    return vec2(bits >> 8) * 5.9604645e-8f;
}

// On the unit disc, evenly (Shirley & Chiu 1997).
vec2 onDisc(vec2 u) {
    vec2 v = 2.0f * u - 1.0f;
    if (v == vec2(0.0f)) return vec2(0.0f);
    bool wide = abs(v.x) > abs(v.y);
    float radius = wide ? v.x : v.y;
    float angle = wide ? 0.25f * kPi * (v.y / v.x) : 0.5f * kPi - 0.25f * kPi * (v.x / v.y);
    return radius * vec2(cos(angle), sin(angle));
}

// About +z, density cosine / pi.
vec3 onCosineHemisphere(vec2 u) {
    vec2 d = onDisc(u);
    return vec3(d, sqrt(max(0.0f, 1.0f - dot(d, d))));
}

const float kPi = 3.14159265f;

// Rays and hits in atlas space.
struct Ray {
    real3 origin;
    real3 direction; // not zero; largest component between 2^-20 and 2^20
    real tMin;
    real tMax;
};

struct Hit {
    real t; // the ray's tMax where nothing was hit
    real u; // weight of v1
    real v; // weight of v2
    uint triangle; // index in the imported file's order, kNoTriangle where nothing was hit
};

// What tracing has cost, counted only if kCountWork.
struct WorkCounters {
    uint rays;
    uint steps; // voxels or leaps
    uint tests; // triangles
    uint selfHits; // rays that hit the triangle which they had just left
};

// 2^exponent, exactly; -126 <= exponent <= 127.
real powerOfTwo(int exponent) {
    return real(uintBitsToFloat(uint(exponent + 127) << 23));
}

// gamma_n = n e / (1 - n e), e = kRoundoff: relative error bound of n roundings (Higham 2002).
real gammaBound(real n) {
    return n * kRoundoff / (1.0f - n * kRoundoff);
}

// Rays and hits in atlas space.
struct Ray {
    vec3 origin;
    vec3 direction; // not zero; largest component between 2^-20 and 2^20
    float tMin;
    float tMax;
};

struct Hit {
    float t; // the ray's tMax where nothing was hit
    float u; // weight of v1
    float v; // weight of v2
    uint triangle; // index in the imported file's order, kNoTriangle where nothing was hit
};

// What tracing has cost, counted only if kCountWork.
struct WorkCounters {
    uint rays;
    uint steps; // voxels or leaps
    uint tests; // triangles
};

// 2^exponent, exactly; -126 <= exponent <= 127.
float powerOfTwo(int exponent) {
    return uintBitsToFloat(uint(exponent + 127) << 23);
}

// gamma_n = n e / (1 - n e), e = 2^-24: relative error bound of n roundings (Higham 2002).
float gammaBound(float n) {
    const float e = 5.9604645e-8f;
    return n * e / (1.0f - n * e);
}

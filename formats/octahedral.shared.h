// Unit vectors in 32 bits: the octahedral map (Meyer et al. 2010), two signed normalized 16-bit numbers.
// Largest error 7e-5 radians.
#ifndef RT_OCTAHEDRAL_H
#define RT_OCTAHEDRAL_H
#ifdef __cplusplus
#include "formats/shared_types.shared.h"
#endif

RT_SHARED_BEGIN

#ifdef __cplusplus
using glm::packSnorm2x16;
using glm::sqrt;
using glm::unpackSnorm2x16;
#endif

/// `n` need not be normalized, but must not be zero.
RT_SHARED_FN uint octEncode(vec3 n) {
    float ax = n.x < 0.0f ? -n.x : n.x;
    float ay = n.y < 0.0f ? -n.y : n.y;
    float az = n.z < 0.0f ? -n.z : n.z;
    float scale = 1.0f / (ax + ay + az);
    vec2 p = vec2(n.x * scale, n.y * scale);
    if (n.z < 0.0f)
        p = vec2((1.0f - ay * scale) * (n.x < 0.0f ? -1.0f : 1.0f),
                 (1.0f - ax * scale) * (n.y < 0.0f ? -1.0f : 1.0f));
    return packSnorm2x16(p);
}

RT_SHARED_FN vec3 octDecode(uint bits) {
    vec2 p = unpackSnorm2x16(bits);
    float ax = p.x < 0.0f ? -p.x : p.x;
    float ay = p.y < 0.0f ? -p.y : p.y;
    vec3 n = vec3(p.x, p.y, 1.0f - ax - ay);
    if (n.z < 0.0f) {
        n.x = (1.0f - ay) * (p.x < 0.0f ? -1.0f : 1.0f);
        n.y = (1.0f - ax) * (p.y < 0.0f ? -1.0f : 1.0f);
    }
    float inverseLength = 1.0f / sqrt(n.x * n.x + n.y * n.y + n.z * n.z);
    return vec3(n.x * inverseLength, n.y * inverseLength, n.z * inverseLength);
}

RT_SHARED_END
#endif

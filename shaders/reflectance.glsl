// How much light a surface reflects, lets through and scatters (see Material in formats/material.shared.h).

const float kSmooth = 0.02f; // surfaces less rough reflect as mirrors do

bool isRough(Surface s) {
    return kHasRoughness && s.roughness >= kSmooth;
}

// Of unpolarized light that meets a dielectric at cosine > 0; eta: index on the light's side / on the other side.
float fresnelDielectric(float cosine, float eta) {
    float sineSquared = eta * eta * (1.0f - cosine * cosine);
    if (sineSquared >= 1.0f) return 1.0f;
    float refracted = sqrt(1.0f - sineSquared);
    float parallel = (cosine - eta * refracted) / (cosine + eta * refracted);
    float across = (eta * cosine - refracted) / (eta * cosine + refracted);
    return 0.5f * (parallel * parallel + across * across);
}

vec3 fresnelMetal(float cosine, vec3 color) { // Schlick 1994
    float away = 1.0f - cosine;
    float square = away * away;
    return color + (1.0f - color) * (square * square * away);
}

// What is reflected of the light that `mirror` does not take. A thin wall reflects between its two faces too.
vec3 reflectedPart(Surface s, float cosine, float eta) {
    if (!kHasReflection) return vec3(0.0f);
    float dielectric = 0.0f;
    if (s.specular > 0.0f && s.metallic < 1.0f) {
        float once = fresnelDielectric(cosine, eta);
        dielectric = s.specular * (s.thin ? 2.0f * once / (1.0f + once) : once);
    }
    return s.metallic > 0.0f ? mix(vec3(dielectric), fresnelMetal(cosine, s.baseColor), s.metallic) : vec3(dielectric);
}

// What goes into the dielectric at cosine, of white light.
float enteringPart(Surface s, float cosine, float eta) {
    float kept = kHasReflection && s.specular > 0.0f ? fresnelDielectric(cosine, eta) : 0.0f;
    if (s.thin) kept = 2.0f * kept / (1.0f + kept);
    return (1.0f - s.mirror) * (1.0f - s.metallic) * (1.0f - s.specular * kept);
}

// Facets' normals are distributed after Trowbridge & Reitz 1975 (GGX; Walter et al. 2007), about +z.
float facetAlpha(Surface s) {
    return s.roughness * s.roughness;
}

float facetDensity(float alpha, float cosine) {
    float square = alpha * alpha;
    float d = cosine * cosine * (square - 1.0f) + 1.0f;
    return square / (kPi * d * d);
}

float smithLambda(float alpha, float cosine) {
    float tangentSquared = max(1.0f / (cosine * cosine) - 1.0f, 0.0f);
    return 0.5f * (sqrt(1.0f + alpha * alpha * tangentSquared) - 1.0f);
}

// Normal of a facet as `towards` (z > 0) sees them (Heitz 2018).
vec3 visibleFacet(float alpha, vec3 towards, vec2 u) {
    vec3 v = normalize(vec3(alpha * towards.xy, towards.z));
    float across = dot(v.xy, v.xy);
    vec3 t1 = across > 0.0f ? vec3(-v.y, v.x, 0.0f) * inversesqrt(across) : vec3(1.0f, 0.0f, 0.0f);
    vec3 t2 = cross(v, t1);
    vec2 d = onDisc(u);
    float s = 0.5f * (1.0f + v.z);
    float y = (1.0f - s) * sqrt(max(0.0f, 1.0f - d.x * d.x)) + s * d.y;
    vec3 h = d.x * t1 + y * t2 + sqrt(max(0.0f, 1.0f - d.x * d.x - y * y)) * v;
    return normalize(vec3(alpha * h.xy, max(1e-6f, h.z)));
}

// Of a direction that visibleFacet() and a reflection give.
float reflectionDensity(float alpha, float cosTowards, float cosFacet) {
    return facetDensity(alpha, cosFacet) / (4.0f * cosTowards * (1.0f + smithLambda(alpha, cosTowards)));
}

// Unit vectors that make a right-handed frame with n (Duff et al. 2017).
mat3 frameAbout(vec3 n) {
    float side = n.z >= 0.0f ? 1.0f : -1.0f;
    float a = -1.0f / (side + n.z);
    float b = n.x * n.y * a;
    return mat3(vec3(1.0f + side * n.x * n.x * a, side * b, -side * n.x), vec3(b, side + n.y * n.y * a, -n.y), n);
}

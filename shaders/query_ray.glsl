// From the records of a batch to rays in atlas space, and from hits back to records.

// False if there is no way to go: a direction that is zero, anything not finite, tMax before tMin.
bool isTraceable(QueryRay query) {
    vec3 size = abs(query.directionTmax.xyz);
    bool finite = all(lessThanEqual(size, vec3(3.4e38f))) && all(lessThanEqual(abs(query.originTmin.xyz), vec3(3.4e38f)));
    bool hasLength = query.originTmin.w <= query.directionTmax.w; // false for NaN
    return hasLength && finite && max(size.x, max(size.y, size.z)) > 0.0f;
}

// Largest power of two that is not above the largest component, as an exponent.
int scaleExponent(vec3 direction) {
    vec3 size = abs(direction);
    return int(floatBitsToUint(max(size.x, max(size.y, size.z))) >> 23) - 127;
}

// World to atlas space, and the direction to about unit size; both by powers of two, so nothing is rounded but the
// origin's offset. World t = atlas t * tScale.
Ray toAtlas(QueryRay query, out real tScale) {
    int exponent = scaleExponent(query.directionTmax.xyz);
    real directionScale = powerOfTwo(clamp(-exponent, -126, 127));
    tScale = directionScale / grid.worldOffset.w;
    real3 origin = (real3(query.originTmin.xyz) - grid.worldOffset.xyz) * grid.worldOffset.w;
    return Ray(origin, query.directionTmax.xyz * directionScale, max(query.originTmin.w, 0.0f) / tScale, min(query.directionTmax.w / tScale, real(3.4e38f)));
}

// t: of the hit, in world space.
#if RT_DOUBLE
#define HitRecord QueryHitDouble
const HitRecord kMiss = QueryHitDouble(-1.0LF, 0.0LF, 0.0LF, kNoTriangle, 0u);
const HitRecord kCut = QueryHitDouble(-1.0LF, 0.0LF, 0.0LF, kWalkCutShort, 0u);
HitRecord record(real t, Hit hit) {
    return QueryHitDouble(t, hit.u, hit.v, hit.triangle, 0u);
}
#else
#define HitRecord QueryHit
const HitRecord kMiss = QueryHit(uvec4(0xBF800000u, 0u, 0u, kNoTriangle)); // t = -1
const HitRecord kCut = QueryHit(uvec4(0xBF800000u, 0u, 0u, kWalkCutShort));
HitRecord record(real t, Hit hit) {
    return QueryHit(uvec4(floatBitsToUint(vec3(t, hit.u, hit.v)), hit.triangle));
}
#endif

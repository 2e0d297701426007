// The first two rows of a matrix that shears space so that the ray runs along the third axis: 0 on the ray.
struct RayShear {
    real3 x;
    real3 y;
};

// 1 for the axis along which the ray runs fastest, 0 for the others.
real3 mainAxis(real3 direction) {
    real3 size = abs(direction);
    bool alongX = size.x >= size.y && size.x >= size.z;
    bool alongY = !alongX && size.y >= size.z;
    return real3(alongX, alongY, !alongX && !alongY);
}

RayShear shearAlong(real3 direction) {
    real3 main = mainAxis(direction);
    real3 first = main.yzx;
    real3 second = main.zxy;
    real inverse = 1.0f / dot(main, direction);
    return RayShear(first - main * (dot(first, direction) * inverse), second - main * (dot(second, direction) * inverse));
}

// Rounded the same way wherever they stand: a compiler that fused the terms now this way, now that, would open cracks, and
// two kernels would give two distances for one hit.
real fixedDot(real3 a, real3 b) {
    precise real sum = fma(a.x, b.x, fma(a.y, b.y, a.z * b.z));
    return sum;
}

real3 fixedCross(real3 a, real3 b) {
    precise real3 minus = a.zxy * b.yzx;
    precise real3 normal = fma(a.yzx, b.zxy, -minus);
    return normal;
}

// Twice the area between the origin, a and b. Exactly the opposite for (b, a): of two triangles that share an edge, one or
// both see a ray that passes it on their side.
real edgeSide(real2 a, real2 b) {
    precise real ab = a.x * b.y;
    precise real ba = a.y * b.x;
    precise real side = ab - ba;
    return side;
}

// Corners of a triangle as seen from the ray's origin, and sheared: 0 is where the ray passes.
struct Corners {
    real3 a, b, c;
    real2 p, q, r;
};

Corners cornersOf(Ray ray, RayShear shear, TriangleRecord triangle) {
    Corners s;
    s.a = real3(triangle.v0.xyz) - ray.origin;
    s.b = real3(triangle.v1.xyz) - ray.origin;
    s.c = real3(triangle.v2.xyz) - ray.origin;
    s.p = real2(fixedDot(shear.x, s.a), fixedDot(shear.y, s.a));
    s.q = real2(fixedDot(shear.x, s.b), fixedDot(shear.y, s.b));
    s.r = real2(fixedDot(shear.x, s.c), fixedDot(shear.y, s.c));
    return s;
}

// Weights of the corners where the ray passes, not divided by their sum. It passes inside if none has another sign.
real3 weightsOf(Corners s) {
    return real3(edgeSide(s.q, s.r), edgeSide(s.r, s.p), edgeSide(s.p, s.q));
}

bool isInside(real3 weights) {
    return min(weights.x, min(weights.y, weights.z)) >= 0.0f || max(weights.x, max(weights.y, weights.z)) <= 0.0f;
}

const real kBoxSlack = 1e-6f; // of the corners' distance from the ray: a few times what moves a ray over an edge

// Whether the ray passes the box of what it sees of the triangle.
bool boxMeetsRay(Corners s) {
    real2 low = min(s.p, min(s.q, s.r)), high = max(s.p, max(s.q, s.r));
    real2 size = max(abs(low), abs(high));
    real slack = kBoxSlack * max(size.x, size.y);
    return max(low.x, low.y) <= slack && min(high.x, high.y) >= -slack;
}

// All weights of a small triangle that lies far from the ray in a line with it are roundings: zeros, and one that is none.
bool isByRounding(real3 weights, Corners s) {
    real3 size = abs(weights);
    return min(size.x, min(size.y, size.z)) == 0.0f && !boxMeetsRay(s);
}

// Twice the area as seen; 0 if edge-on: its neighbours are hit.
real areaOf(real3 weights) {
    precise real area = weights.x + weights.y + weights.z;
    return area;
}

// Of two hits at the same t the lower index is nearer, so that the winner does not depend on the order of the tests.
bool isNearer(real t, uint id, Hit best) {
    return t < best.t || (t == best.t && id < best.triangle);
}

real3 normalOf(TriangleRecord triangle) {
    real3 v0 = real3(triangle.v0.xyz);
    return fixedCross(real3(triangle.v1.xyz) - v0, real3(triangle.v2.xyz) - v0);
}

// Watertight: Woop, Benthin & Wald 2013. Keeps the nearer of `best` and the hit with `triangle`, if there is one at or
// after tMin.
Hit intersectTriangle(Ray ray, RayShear shear, TriangleRecord triangle, Hit best) {
    Corners s = cornersOf(ray, shear, triangle);
    real3 weights = weightsOf(s);
    if (isInside(weights)) {
        real area = areaOf(weights);
        // From the plane: a ray that leaves the triangle next to it keeps its side, which weights of far corners would blur.
        real3 normal = normalOf(triangle);
        real facing = fixedDot(normal, ray.direction);
        // Edge-on, or with corners in a line: not there but for rounding, which may leave it as the only one that sees the ray.
        if (facing == 0.0f) {
            normal = ray.direction;
            facing = fixedDot(normal, normal);
        }
        precise real t = fixedDot(normal, s.a) / facing;
        uint id = floatBitsToUint(triangle.v0.w);
        bool isHit = t >= ray.tMin && isNearer(t, id, best) && area != 0.0f && !isByRounding(weights, s);
        if (isHit) best = Hit(t, weights.y / area, weights.z / area, id);
    }
    return best;
}

// Moller & Trumbore 1997, without an epsilon: leaks where a ray meets an edge.
Hit intersectMollerTrumbore(Ray ray, TriangleRecord triangle, Hit best) {
    real3 v0 = real3(triangle.v0.xyz);
    real3 edge1 = real3(triangle.v1.xyz) - v0, edge2 = real3(triangle.v2.xyz) - v0;
    real3 p = fixedCross(ray.direction, edge2);
    precise real inverse = 1.0f / fixedDot(edge1, p); // infinite if edge-on: no comparison below holds then
    real3 fromV0 = ray.origin - v0;
    precise real u = fixedDot(fromV0, p) * inverse;
    real3 q = fixedCross(fromV0, edge1);
    precise real v = fixedDot(ray.direction, q) * inverse;
    precise real t = fixedDot(edge2, q) * inverse;
    uint id = floatBitsToUint(triangle.v0.w);
    if (u >= 0.0f && v >= 0.0f && u + v <= 1.0f && t >= ray.tMin && isNearer(t, id, best)) best = Hit(t, u, v, id);
    return best;
}

real fixedAffine(real4 row, real3 point) {
    precise real sum = fma(row.x, point.x, fma(row.y, point.y, fma(row.z, point.z, row.w)));
    return sum;
}

#if RT_DOUBLE
#define RealTransform TriangleTransformDouble
#else
#define RealTransform TriangleTransform
#endif
// Baldwin & Weber 2016: into the space where the triangle is (0,0), (1,0), (0,1), by a stored transform.
Hit intersectTransformed(Ray ray, RealTransform triangle, uint id, Hit best) {
    real toPlane = fixedAffine(triangle.plane, ray.origin);
    precise real t = -toPlane / fixedDot(triangle.plane.xyz, ray.direction);
    precise real3 point = fma(ray.direction, real3(t), ray.origin);
    real u = fixedAffine(triangle.u, point);
    real v = fixedAffine(triangle.v, point);
    if (u >= 0.0f && v >= 0.0f && u + v <= 1.0f && t >= ray.tMin && isNearer(t, id, best)) best = Hit(t, u, v, id);
    return best;
}

#include "shaders/sliver.glsl"

// The test that this variant was compiled for.
Hit intersectShape(Ray ray, RayShear shear, uint id, Hit best) {
#if RT_INTERSECT == 2 // kIntersectBaldwinWeber: loadTransform() exists
    return intersectTransformed(ray, loadTransform(id), id, best);
#else
    TriangleRecord triangle = loadTriangle(id);
    if (kIntersect == kIntersectMollerTrumbore) return intersectMollerTrumbore(ray, triangle, best);
    if (kHasSlivers && triangle.v1.w != 0.0f) return intersectSliver(ray, shear, triangle, best);
    return intersectTriangle(ray, shear, triangle, best);
#endif
}

#ifndef RT_KNOWS_CUTOUTS // texture.glsl, where surfaces are shaded
bool isCutOut(Hit hit) {
    return false;
}
#endif

Hit intersectEntry(Ray ray, RayShear shear, uint id, Hit best) {
    Hit found = intersectShape(ray, shear, id, best);
    return kHasCutouts && found.triangle != best.triangle && isCutOut(found) ? best : found;
}

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

real fixedDot2(real2 a, real2 b) {
    precise real sum = fma(a.x, b.x, a.y * b.y);
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

real sumOfSizes(real3 v) {
    return abs(v.x) + abs(v.y) + abs(v.z);
}

// A triangle as its ray sees it.
struct SeenTriangle {
    real3 a, b, c; // corners, the ray's origin at 0
    real2 p, q, r; // sheared
    real3 weights; // of the corners, where the ray passes
};

// Distance to a triangle that is so slender, or so much edge-on, that its plane does not tell. The weights have large errors
// too, but for the larger part along the longest edge: so far as the point that they give lies beside the ray, it is moved back
// along that edge. It is then on the triangle, and beside the ray by rounding.
real slenderDistance(real3 direction, SeenTriangle s) {
    real3 main = mainAxis(direction);
    precise real3 along = real3(dot(main, s.a), dot(main, s.b), dot(main, s.c)) / dot(main, direction);
    precise real2 beside = fma(s.p, real2(s.weights.x), fma(s.q, real2(s.weights.y), s.r * s.weights.z));
    real3 edge = real3(s.q - s.p, along.y - along.x);
    real3 edgeB = real3(s.r - s.q, along.z - along.y);
    real3 edgeC = real3(s.p - s.r, along.x - along.z);
    if (fixedDot2(edgeB.xy, edgeB.xy) > fixedDot2(edge.xy, edge.xy)) edge = edgeB;
    if (fixedDot2(edgeC.xy, edgeC.xy) > fixedDot2(edge.xy, edge.xy)) edge = edgeC;
    real square = fixedDot2(edge.xy, edge.xy);
    precise real back = square > 0.0f ? fixedDot2(beside, edge.xy) / square : 0.0f;
    precise real t = fma(-back, edge.z, fixedDot(s.weights, along));
    return clamp(t, min(along.x, min(along.y, along.z)), max(along.x, max(along.y, along.z)));
}

const real kSlender = 0.0009765625f; // 2^-10: the plane's distance has lost 10 bits then

// Watertight: Woop, Benthin & Wald 2013. Keeps the nearer of `best` and the hit with `triangle`, if there is one at or
// after tMin; of hits at the same t the lower index, so that the winner does not depend on the order of the tests.
Hit intersectTriangle(Ray ray, RayShear shear, TriangleRecord triangle, Hit best) {
    real3 v0 = real3(triangle.v0.xyz), v1 = real3(triangle.v1.xyz), v2 = real3(triangle.v2.xyz);
    real3 a = v0 - ray.origin;
    real3 b = v1 - ray.origin;
    real3 c = v2 - ray.origin;
    real2 p = real2(fixedDot(shear.x, a), fixedDot(shear.y, a));
    real2 q = real2(fixedDot(shear.x, b), fixedDot(shear.y, b));
    real2 r = real2(fixedDot(shear.x, c), fixedDot(shear.y, c));
    real u = edgeSide(q, r);
    real v = edgeSide(r, p);
    real w = edgeSide(p, q);
    if (min(u, min(v, w)) >= 0.0f || max(u, max(v, w)) <= 0.0f) {
        precise real area = u + v + w; // 0 if edge-on: its neighbours are hit
        // From the plane: a ray that leaves the triangle next to it keeps its side, which u, v and w of far corners would blur.
        real3 edge1 = v1 - v0, edge2 = v2 - v0;
        real3 normal = fixedCross(edge1, edge2);
        real facing = fixedDot(normal, ray.direction);
        real t = fixedDot(normal, a) / facing;
        precise real size = sumOfSizes(edge1) * sumOfSizes(edge2);
        if (abs(facing) < kSlender * size) {
            real refined = slenderDistance(ray.direction, SeenTriangle(a, b, c, p, q, r, real3(u, v, w) / area));
            // The plane of a triangle that is edge-on still says whether it is ahead; that of a sliver is chance.
            bool hasPlane = sumOfSizes(normal) > kSlender * size && facing != 0.0f;
            if (!hasPlane) t = refined;
            else if (t >= 0.0f) t = max(refined, 0.0f);
        }
        uint id = floatBitsToUint(triangle.v0.w);
        bool nearer = t < best.t || (t == best.t && id < best.triangle);
        if (t >= ray.tMin && nearer && area != 0.0f) best = Hit(t, v / area, w / area, id);
    }
    return best;
}

// Moller & Trumbore 1997, without an epsilon: leaks where a ray meets an edge.
Hit intersectMollerTrumbore(Ray ray, TriangleRecord triangle, Hit best) {
    real3 v0 = real3(triangle.v0.xyz);
    real3 edge1 = real3(triangle.v1.xyz) - v0, edge2 = real3(triangle.v2.xyz) - v0;
    real3 p = cross(ray.direction, edge2);
    real inverse = 1.0f / dot(edge1, p); // infinite if edge-on: no comparison below holds then
    real3 fromV0 = ray.origin - v0;
    real u = dot(fromV0, p) * inverse;
    real3 q = cross(fromV0, edge1);
    real v = dot(ray.direction, q) * inverse;
    real t = dot(edge2, q) * inverse;
    uint id = floatBitsToUint(triangle.v0.w);
    bool nearer = t < best.t || (t == best.t && id < best.triangle);
    if (u >= 0.0f && v >= 0.0f && u + v <= 1.0f && t >= ray.tMin && nearer) best = Hit(t, u, v, id);
    return best;
}

// Baldwin & Weber 2016: into the space where the triangle is (0,0), (1,0), (0,1), by a stored transform.
Hit intersectTransformed(Ray ray, TriangleTransform triangle, uint id, Hit best) {
    real toPlane = dot(real3(triangle.plane.xyz), ray.origin) + triangle.plane.w;
    real t = -toPlane / dot(real3(triangle.plane.xyz), ray.direction);
    real3 point = ray.origin + ray.direction * t;
    real u = dot(real3(triangle.u.xyz), point) + triangle.u.w;
    real v = dot(real3(triangle.v.xyz), point) + triangle.v.w;
    bool nearer = t < best.t || (t == best.t && id < best.triangle);
    if (u >= 0.0f && v >= 0.0f && u + v <= 1.0f && t >= ray.tMin && nearer) best = Hit(t, u, v, id);
    return best;
}

// The test that this variant was compiled for.
Hit intersectEntry(Ray ray, RayShear shear, uint id, Hit best) {
#if RT_INTERSECT == 2 // kIntersectBaldwinWeber: loadTransform() exists
    return intersectTransformed(ray, loadTransform(id), id, best);
#else
    if (kIntersect == kIntersectMollerTrumbore) return intersectMollerTrumbore(ray, loadTriangle(id), best);
    return intersectTriangle(ray, shear, loadTriangle(id), best);
#endif
}

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

// A triangle as its ray sees it: corners sheared (xy) and how far along the ray they are (z), and their weights where the ray
// passes.
struct SeenTriangle {
    real3 p, q, r;
    real3 weights;
};

// So that the edge p q is the longest as seen.
SeenTriangle turned(SeenTriangle s) {
    real2 pq = s.q.xy - s.p.xy, qr = s.r.xy - s.q.xy, rp = s.p.xy - s.r.xy;
    real3 squares = real3(fixedDot2(pq, pq), fixedDot2(qr, qr), fixedDot2(rp, rp));
    if (squares.x >= squares.y && squares.x >= squares.z) return s;
    if (squares.y >= squares.z) return SeenTriangle(s.q, s.r, s.p, s.weights.yzx);
    return SeenTriangle(s.r, s.p, s.q, s.weights.zxy);
}

// How far along the ray an edge is where the ray passes it.
real distanceToEdge(real3 from, real3 to) {
    real3 edge = to - from;
    real square = fixedDot2(edge.xy, edge.xy);
    precise real at = square > 0.0f ? clamp(-fixedDot2(from.xy, edge.xy) / square, 0.0f, 1.0f) : 0.0f;
    precise real t = fma(at, edge.z, from.z);
    return t;
}

// Distance to a triangle that is so slender, or so much edge-on, that its plane does not tell. The weights have large errors
// too, but for the larger part along the longest edge: so far as the point that they give lies beside the ray, it is moved back
// along that edge, and where that leads out of the triangle, to the other edges. It is then on the triangle, and beside the ray
// by rounding.
real slenderDistance(SeenTriangle seen) {
    SeenTriangle s = turned(seen);
    real3 edge = s.q - s.p;
    real square = fixedDot2(edge.xy, edge.xy);
    precise real2 beside = fma(s.p.xy, s.weights.xx, fma(s.q.xy, s.weights.yy, s.r.xy * s.weights.z));
    precise real back = square > 0.0f ? fixedDot2(beside, edge.xy) / square : 0.0f;
    precise real3 weights = s.weights + real3(back, -back, 0.0f);
    if (weights.x < 0.0f) return distanceToEdge(s.q, s.r);
    if (weights.y < 0.0f) return distanceToEdge(s.p, s.r);
    return fixedDot(weights, real3(s.p.z, s.q.z, s.r.z));
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
            real3 main = mainAxis(ray.direction);
            precise real3 along = real3(dot(main, a), dot(main, b), dot(main, c)) / dot(main, ray.direction);
            real3 weights = real3(u, v, w) / area;
            real refined = slenderDistance(SeenTriangle(real3(p, along.x), real3(q, along.y), real3(r, along.z), weights));
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
    real3 p = fixedCross(ray.direction, edge2);
    precise real inverse = 1.0f / fixedDot(edge1, p); // infinite if edge-on: no comparison below holds then
    real3 fromV0 = ray.origin - v0;
    precise real u = fixedDot(fromV0, p) * inverse;
    real3 q = fixedCross(fromV0, edge1);
    precise real v = fixedDot(ray.direction, q) * inverse;
    precise real t = fixedDot(edge2, q) * inverse;
    uint id = floatBitsToUint(triangle.v0.w);
    bool nearer = t < best.t || (t == best.t && id < best.triangle);
    if (u >= 0.0f && v >= 0.0f && u + v <= 1.0f && t >= ray.tMin && nearer) best = Hit(t, u, v, id);
    return best;
}

real fixedAffine(vec4 row, real3 point) {
    precise real sum = fma(real(row.x), point.x, fma(real(row.y), point.y, fma(real(row.z), point.z, real(row.w))));
    return sum;
}

// Baldwin & Weber 2016: into the space where the triangle is (0,0), (1,0), (0,1), by a stored transform.
Hit intersectTransformed(Ray ray, TriangleTransform triangle, uint id, Hit best) {
    real toPlane = fixedAffine(triangle.plane, ray.origin);
    precise real t = -toPlane / fixedDot(real3(triangle.plane.xyz), ray.direction);
    precise real3 point = fma(ray.direction, real3(t), ray.origin);
    real u = fixedAffine(triangle.u, point);
    real v = fixedAffine(triangle.v, point);
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

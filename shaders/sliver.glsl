// Triangles so slender that their plane does not tell where a ray meets them.

real sumOfSizes(real3 v) {
    return abs(v.x) + abs(v.y) + abs(v.z);
}

real fixedDot2(real2 a, real2 b) {
    precise real sum = fma(a.x, b.x, a.y * b.y);
    return sum;
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

// The weights have large errors too, but for the larger part along the longest edge: so far as the point that they give lies
// beside the ray, it is moved back along that edge, and where that leads out of the triangle, to the other edges. It is then on
// the triangle, and beside the ray by rounding.
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

// intersectTriangle() for slivers.
Hit intersectSliver(Ray ray, RayShear shear, TriangleRecord triangle, Hit best) {
    Corners s = cornersOf(ray, shear, triangle);
    real3 weights = weightsOf(s);
    real area = areaOf(weights);
    if (!isInside(weights) || area == 0.0f || isByRounding(weights, s)) return best;
    real3 main = mainAxis(ray.direction);
    precise real3 along = real3(dot(main, s.a), dot(main, s.b), dot(main, s.c)) / dot(main, ray.direction);
    real t = slenderDistance(SeenTriangle(real3(s.p, along.x), real3(s.q, along.y), real3(s.r, along.z), weights / area));
    // The plane of a triangle that is edge-on still says whether it is ahead; that of a true sliver is chance.
    real3 normal = normalOf(triangle);
    real facing = fixedDot(normal, ray.direction);
    real size = sumOfSizes(s.b - s.a) * sumOfSizes(s.c - s.a);
    if (sumOfSizes(normal) > kSlender * size && facing != 0.0f) {
        real toPlane = fixedDot(normal, s.a) / facing;
        t = toPlane < 0.0f ? toPlane : max(t, 0.0f);
    }
    uint id = floatBitsToUint(triangle.v0.w);
    if (t >= ray.tMin && isNearer(t, id, best)) best = Hit(t, weights.y / area, weights.z / area, id);
    return best;
}

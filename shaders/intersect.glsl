// The first two rows of a matrix that shears space so that the ray runs along the third axis: 0 on the ray.
struct RayShear {
    vec3 x;
    vec3 y;
};

RayShear shearAlong(vec3 direction) {
    vec3 size = abs(direction);
    bool alongX = size.x >= size.y && size.x >= size.z;
    bool alongY = !alongX && size.y >= size.z;
    vec3 main = alongX ? vec3(1, 0, 0) : alongY ? vec3(0, 1, 0) : vec3(0, 0, 1);
    vec3 first = main.yzx;
    vec3 second = main.zxy;
    float inverse = 1.0f / dot(main, direction);
    return RayShear(first - main * (dot(first, direction) * inverse), second - main * (dot(second, direction) * inverse));
}

// Rounded the same way wherever they stand: a compiler that fused the terms now this way, now that, would open cracks, and
// two kernels would give two distances for one hit.
float fixedDot(vec3 a, vec3 b) {
    precise float sum = fma(a.x, b.x, fma(a.y, b.y, a.z * b.z));
    return sum;
}

vec3 fixedCross(vec3 a, vec3 b) {
    precise vec3 minus = a.zxy * b.yzx;
    precise vec3 normal = fma(a.yzx, b.zxy, -minus);
    return normal;
}

// Twice the area between the origin, a and b. Exactly the opposite for (b, a): of two triangles that share an edge, one or
// both see a ray that passes it on their side.
float edgeSide(vec2 a, vec2 b) {
    precise float ab = a.x * b.y;
    precise float ba = a.y * b.x;
    precise float side = ab - ba;
    return side;
}

// Watertight: Woop, Benthin & Wald 2013. Keeps the nearer of `best` and the hit with `triangle`, if there is one at or
// after tMin; of hits at the same t the lower index, so that the winner does not depend on the order of the tests.
Hit intersectTriangle(Ray ray, RayShear shear, TriangleRecord triangle, Hit best) {
    vec3 a = triangle.v0.xyz - ray.origin;
    vec3 b = triangle.v1.xyz - ray.origin;
    vec3 c = triangle.v2.xyz - ray.origin;
    vec2 p = vec2(fixedDot(shear.x, a), fixedDot(shear.y, a));
    vec2 q = vec2(fixedDot(shear.x, b), fixedDot(shear.y, b));
    vec2 r = vec2(fixedDot(shear.x, c), fixedDot(shear.y, c));
    float u = edgeSide(q, r);
    float v = edgeSide(r, p);
    float w = edgeSide(p, q);
    if (min(u, min(v, w)) >= 0.0f || max(u, max(v, w)) <= 0.0f) {
        precise float area = u + v + w; // 0 if edge-on: its neighbours are hit
        // From the plane: a ray that leaves the triangle next to it keeps its side, which u, v and w of far corners would blur.
        vec3 normal = fixedCross(triangle.v1.xyz - triangle.v0.xyz, triangle.v2.xyz - triangle.v0.xyz);
        float facing = fixedDot(normal, ray.direction);
        float t = fixedDot(normal, a) / facing;
        uint id = floatBitsToUint(triangle.v0.w);
        bool nearer = t < best.t || (t == best.t && id < best.triangle);
        if (t >= ray.tMin && nearer && area != 0.0f && facing != 0.0f) best = Hit(t, v / area, w / area, id);
    }
    return best;
}

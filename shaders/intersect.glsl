// Moller & Trumbore 1997. Keeps the nearer of `best` and the hit with `triangle`, if there is one at or after tMin; of
// hits at the same t the lower index, so that the winner does not depend on the order of the tests.
Hit intersectTriangle(Ray ray, TriangleRecord triangle, Hit best) {
    vec3 edge1 = triangle.v1.xyz - triangle.v0.xyz;
    vec3 edge2 = triangle.v2.xyz - triangle.v0.xyz;
    vec3 p = cross(ray.direction, edge2);
    float inverseDet = 1.0f / dot(edge1, p); // infinite for an edge-on triangle: the comparisons below fail then
    vec3 fromV0 = ray.origin - triangle.v0.xyz;
    vec3 q = cross(fromV0, edge1);
    float u = dot(fromV0, p) * inverseDet;
    float v = dot(ray.direction, q) * inverseDet;
    float t = dot(edge2, q) * inverseDet;
    uint id = floatBitsToUint(triangle.v0.w);
    bool inside = u >= 0.0f && v >= 0.0f && u + v <= 1.0f && t >= ray.tMin;
    bool nearer = t < best.t || (t == best.t && id < best.triangle);
    if (inside && nearer) return Hit(t, u, v, id);
    return best;
}

// What a ray finds at a hit, in atlas space.
struct Surface {
    uint triangle;
    uint material;
    real3 position;
    real3 positionError; // bound of the rounding error of each coordinate, and of the plane that triangle tests see
    real3 geometricNormal; // unit, on the side that the ray came from
    real3 normal; // interpolated, unit, on that same side
    bool entering; // the ray meets the outside
    vec3 baseColor; // linear
    vec3 emission;
    float opacity;
    float metallic;
    float roughness; // 0 if the variant has none
    float specular;
    float mirror;
    float transmission;
    bool thin;
    bool unlit;
};

real3 interpolateNormal(uvec4 vertices, real3 weights, real3 fallback) {
    real3 n = weights.x * octDecode(loadNormal(vertices.x)) + weights.y * octDecode(loadNormal(vertices.y)) +
             weights.z * octDecode(loadNormal(vertices.z));
    real squaredLength = dot(n, n);
    return squaredLength > 1e-12f ? n * inversesqrt(squaredLength) : fallback;
}

// Unit normal, and the sine of the angle at v0; edges are scaled to unit size first, since the cross product of tiny ones would
// underflow. `fallback` where the corners are in line as far as floats can tell.
real3 faceNormal(TriangleRecord triangle, real3 fallback, out real sine) {
    real3 v0 = real3(triangle.v0.xyz);
    real3 n = cross(normalize(real3(triangle.v1.xyz) - v0), normalize(real3(triangle.v2.xyz) - v0));
    sine = sqrt(dot(n, n));
    return sine > 0.0f ? n / sine : normalize(fallback);
}

const real kLeastSine = 1.0f / 64.0f; // more slender triangles would move rays too far

// How far a triangle test, which works from v0 on, may see the plane beside itself: the edges, their product and its product
// with the way to v0 are rounded, and the slenderer the triangle, the more its normal turns by that.
real3 planeError(TriangleRecord triangle, real sine) {
    real3 v0 = real3(triangle.v0.xyz);
    real3 reach = abs(real3(triangle.v1.xyz) - v0) + abs(real3(triangle.v2.xyz) - v0);
    return gammaBound(8.0f) / max(sine, kLeastSine) * reach;
}

// How a triangle lies in texture space.
struct TextureFrame {
    vec2 edge1, edge2; // texture coordinates along the triangle's edges
    float area;        // of texture space for one of the triangle's, both doubled
};

TextureFrame textureFrame(uvec4 vertices, TriangleRecord triangle) {
#if RT_HAS_TEXTURES
    vec2 t0 = loadTexcoord(vertices.x);
    vec2 edge1 = loadTexcoord(vertices.y) - t0, edge2 = loadTexcoord(vertices.z) - t0;
    vec3 across = cross(triangle.v1.xyz - triangle.v0.xyz, triangle.v2.xyz - triangle.v0.xyz);
    return TextureFrame(edge1, edge2, abs(edge1.x * edge2.y - edge1.y * edge2.x) / max(length(across), 1e-30f));
#else
    return TextureFrame(vec2(0.0f), vec2(0.0f), 0.0f);
#endif
}

// The shading normal turned as the normal image says; its axes follow the texture coordinates.
real3 bentNormal(Surface s, Material material, TriangleRecord triangle, TextureFrame frame, vec2 texcoord, float footprint) {
    float winding = frame.edge1.x * frame.edge2.y - frame.edge1.y * frame.edge2.x;
    vec3 edge1 = triangle.v1.xyz - triangle.v0.xyz, edge2 = triangle.v2.xyz - triangle.v0.xyz;
    vec3 tangent = (frame.edge2.y * edge1 - frame.edge1.y * edge2) * sign(winding);
    vec3 outward = vec3(s.entering ? s.normal : -s.normal);
    tangent -= outward * dot(outward, tangent);
    float tangentLength = length(tangent);
    if (!(tangentLength > 0.0f) || winding == 0.0f) return s.normal;
    tangent /= tangentLength;
    vec3 bitangent = cross(outward, tangent) * sign(winding);
    vec3 map = 2.0f * sampleImage(material.images.z, texcoord, footprint).xyz - 1.0f;
    vec3 bent = tangent * (map.x * material.attenuation.w) + bitangent * (map.y * material.attenuation.w) + outward * max(map.z, 1e-3f);
    return normalize(real3(s.entering ? bent : -bent));
}

// What the material and its images say; s has its place and normals.
void addMaterial(inout Surface s, Material m, uvec4 vertices, TriangleRecord triangle, vec3 weights, float width, float cosine) {
    vec2 texcoord = texcoordAt(vertices, weights);
    TextureFrame frame = textureFrame(vertices, triangle);
    float footprint = kHasTextures ? width * sqrt(frame.area / max(cosine, 0.05f)) : 0.0f;
    vec4 color = m.baseColor * imageOr(m.images.x, texcoord, footprint, vec4(1.0f));
    vec4 rough = imageOr(m.images.y, texcoord, footprint, vec4(1.0f));
    s.baseColor = color.rgb;
    bool fades = kHasOpacity && (m.more.y & kMaterialClear) != 0u && m.transmission.w == 0.0f;
    s.opacity = fades ? color.a : 1.0f;
    s.emission = kHasEmission ? m.emission.rgb * imageOr(m.images.w, texcoord, footprint, vec4(1.0f)).rgb : vec3(0.0f);
    s.unlit = kHasEmission && (m.more.y & kMaterialUnlit) != 0u;
    s.metallic = kHasReflection ? m.reflection.x * rough.b : 0.0f;
    s.roughness = kHasRoughness ? m.reflection.y * rough.g : 0.0f;
    s.specular = kHasReflection ? m.reflection.z : 0.0f;
    s.mirror = kHasReflection ? m.reflection.w : 0.0f;
    s.transmission = kHasTransmission ? m.transmission.x * imageOr(m.more.x, texcoord, footprint, vec4(1.0f)).r : 0.0f;
    s.thin = kHasTransmission && (m.more.y & kMaterialThin) != 0u;
    if (kHasNormalImages && m.images.z != kNoImage) s.normal = bentNormal(s, m, triangle, frame, texcoord, footprint);
}

// `width`: of what the pixel covers of a plane across the ray.
Surface surfaceAt(Ray ray, Hit hit, float width) {
    TriangleRecord triangle = loadTriangle(hit.triangle);
    uvec4 vertices = loadTriangleVertices(hit.triangle);
    real3 weights = real3(1.0f - hit.u - hit.v, hit.u, hit.v);
    real3 v0 = weights.x * real3(triangle.v0.xyz), v1 = weights.y * real3(triangle.v1.xyz), v2 = weights.z * real3(triangle.v2.xyz);
    Surface s;
    s.triangle = hit.triangle;
    s.material = vertices.w;
    // From the weights, not along the ray: the error is then that of the triangle, however far the ray has come
    // (Pharr, Jakob & Humphreys 2016, section 3.9).
    s.position = v0 + v1 + v2;
    real sine;
    real3 outward = faceNormal(triangle, -ray.direction, sine);
    s.positionError = gammaBound(7.0f) * (abs(v0) + abs(v1) + abs(v2)) + planeError(triangle, sine);
    s.entering = dot(outward, ray.direction) <= 0.0f;
    s.geometricNormal = s.entering ? outward : -outward;
    s.normal = interpolateNormal(vertices, weights, outward);
    // The file's normals say which side is meant to be seen; only their direction relative to the face counts here.
    if (dot(s.normal, s.geometricNormal) < 0.0f) s.normal = -s.normal;
    float cosine = float(abs(dot(s.geometricNormal, normalize(ray.direction))));
    addMaterial(s, materials[vertices.w], vertices, triangle, vec3(weights), width, cosine);
    return s;
}

// A little more or less than x: at least the next number up or down; near 0, where a triangle test would underflow, 1e-20. Atlas
// space is about unit size, so that is far below any rounding error.
real nudged(real x, bool up) {
    real amount = max(abs(x) * 2.0f * kRoundoff, real(1e-20f));
    return up ? x + amount : x - amount;
}

// Where a ray in `direction` leaves the surface: outside the box in which the true hit lies (Pharr, Jakob & Humphreys
// 2016, section 3.9.5), so that it cannot hit the same triangle again.
real3 leaveSurface(Surface s, real3 direction) {
    real3 side = dot(direction, s.geometricNormal) >= 0.0f ? s.geometricNormal : -s.geometricNormal;
    real3 moved = s.position + side * dot(abs(side), s.positionError);
    return real3(nudged(moved.x, side.x >= 0.0f), nudged(moved.y, side.y >= 0.0f), nudged(moved.z, side.z >= 0.0f));
}

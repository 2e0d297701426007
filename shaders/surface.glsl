// What a ray finds at a hit, in atlas space.
struct Surface {
    uint triangle;
    real3 position;
    real3 positionError; // bound of the rounding error of each coordinate, and of the plane that triangle tests see
    real3 geometricNormal; // unit, on the side that the ray came from
    real3 normal; // interpolated, unit, on that same side
    vec3 albedo; // linear
    vec3 emission;
    float reflectivity;
    float transmission;
    float eta; // index of refraction on the ray's side / on the other side
};

// x is at most two periods below 0, as sampleImage() gives it. In whole numbers: a float division may be off by one unit
// in the last place, and a whole period with it.
int wrapTexel(int x, int size, uint wrap) {
    if (wrap == kWrapClamp) return clamp(x, 0, size - 1);
    int period = wrap == kWrapMirror ? 2 * size : size;
    int inPeriod = (x + 2 * period) % period;
    return inPeriod < size ? inPeriod : period - 1 - inPeriod;
}

#if RT_HAS_TEXTURES // else the images and pages are not declared
vec3 fetchTexel(ImagePlace place, ivec2 texel) {
    ivec2 wrapped = ivec2(wrapTexel(texel.x, int(place.rect.z), place.page.y), wrapTexel(texel.y, int(place.rect.w), place.page.z));
    return texelFetch(texturePages, ivec3(ivec2(place.rect.xy) + wrapped, int(place.page.x)), 0).rgb;
}

// Bilinear, in linear light: the pages are sRGB textures, decoded before they are mixed.
vec3 sampleImage(ImagePlace place, vec2 texcoord) {
    vec2 size = vec2(place.rect.zw);
    // Whole periods away from the image are taken off first: a float has no digits left for texels far out.
    vec2 period = vec2(place.page.y == kWrapMirror ? 2.0f : 1.0f, place.page.z == kWrapMirror ? 2.0f : 1.0f);
    vec2 near = texcoord - period * floor(texcoord / period);
    vec2 uv = vec2(place.page.y == kWrapClamp ? clamp(texcoord.x, 0.0f, 1.0f) : near.x,
                   place.page.z == kWrapClamp ? clamp(texcoord.y, 0.0f, 1.0f) : near.y);
    vec2 position = vec2(uv.x, 1.0f - uv.y) * size - 0.5f;
    vec2 weight = fract(position);
    ivec2 texel = ivec2(floor(position));
    vec3 top = mix(fetchTexel(place, texel), fetchTexel(place, texel + ivec2(1, 0)), weight.x);
    vec3 bottom = mix(fetchTexel(place, texel + ivec2(0, 1)), fetchTexel(place, texel + ivec2(1, 1)), weight.x);
    return mix(top, bottom, weight.y);
}

vec3 imageColor(uint image, uvec4 vertices, vec3 weights) {
    vec2 texcoord = weights.x * loadTexcoord(vertices.x) + weights.y * loadTexcoord(vertices.y) + weights.z * loadTexcoord(vertices.z);
    return sampleImage(images[image], texcoord);
}
#else
vec3 imageColor(uint image, uvec4 vertices, vec3 weights) {
    return vec3(1.0f);
}
#endif

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

Surface surfaceAt(Ray ray, Hit hit) {
    TriangleRecord triangle = loadTriangle(hit.triangle);
    uvec4 vertices = loadTriangleVertices(hit.triangle);
    Material material = materials[vertices.w];
    real3 weights = real3(1.0f - hit.u - hit.v, hit.u, hit.v);
    real3 v0 = weights.x * real3(triangle.v0.xyz), v1 = weights.y * real3(triangle.v1.xyz), v2 = weights.z * real3(triangle.v2.xyz);
    Surface s;
    s.triangle = hit.triangle;
    // From the weights, not along the ray: the error is then that of the triangle, however far the ray has come
    // (Pharr, Jakob & Humphreys 2016, section 3.9).
    s.position = v0 + v1 + v2;
    real sine;
    real3 outward = faceNormal(triangle, -ray.direction, sine);
    s.positionError = gammaBound(7.0f) * (abs(v0) + abs(v1) + abs(v2)) + planeError(triangle, sine);
    bool entering = dot(outward, ray.direction) <= 0.0f;
    s.geometricNormal = entering ? outward : -outward;
    s.normal = interpolateNormal(vertices, weights, outward);
    // The file's normals say which side is meant to be seen; only their direction relative to the face counts here.
    if (dot(s.normal, s.geometricNormal) < 0.0f) s.normal = -s.normal;
    s.albedo = material.baseColor.rgb;
    if (kHasTextures && material.images.x != kNoImage) s.albedo *= imageColor(material.images.x, vertices, vec3(weights));
    s.emission = kHasEmission ? material.emission.rgb : vec3(0.0f);
    s.reflectivity = kHasReflection ? material.reflection.w : 0.0f;
    s.transmission = kHasTransmission ? (1.0f - material.reflection.w) * material.transmission.x : 0.0f;
    s.eta = entering ? 1.0f / material.transmission.y : material.transmission.y;
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

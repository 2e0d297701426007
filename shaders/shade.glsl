// Light at a hit, and the rays that go on from it (Whitted 1980).
const float kPi = 3.14159265f;
const float kLeastWeight = 1e-3f; // rays whose light counts less than this in the pixel are not traced

// Radiance that one light sends through the surface to the eye; black if the light is hidden. Transmissive surfaces
// hide it too.
vec3 directLight(Surface s, Light light, inout WorkCounters work) {
    real3 toLight = light.position.xyz - s.position;
    real squaredDistance = dot(toLight, toLight);
    real cosine = dot(s.normal, toLight) * inversesqrt(squaredDistance);
    if (!(cosine > 0.0f) || dot(s.geometricNormal, toLight) <= 0.0f) return vec3(0.0f);
    real3 origin = leaveSurface(s, toLight);
    Hit blocker = trace(Ray(origin, light.position.xyz - origin, 0.0f, 1.0f), true, work);
    if (kCountWork && blocker.triangle == s.triangle) work.selfHits += 1u;
    if (blocker.triangle != kNoTriangle) return vec3(0.0f);
    return s.albedo * light.intensity.rgb * float(cosine / (kPi * squaredDistance));
}

vec3 localLight(Surface s, inout WorkCounters work) {
    float diffuse = max(1.0f - s.reflectivity - s.transmission, 0.0f);
    vec3 color = s.emission;
    if (diffuse > 0.0f) {
        vec3 received = s.albedo * picture.ambient.rgb;
        if (kHasLights)
            for (uint i = 0u; i < grid.counts.w; ++i) received += directLight(s, lights[i], work);
        color += diffuse * received;
    }
    return color;
}

// A ray that waits to be traced, and how much its light counts in the pixel.
struct Pending {
    real3 origin;
    real3 direction;
    vec3 weight;
    uint depth;
    uint from; // triangle that it leaves; kNoTriangle at the eye
};

// Each hit takes one ray off the stack and puts at most two on it, each one deeper.
const uint kStackSize = kHasReflection && kHasTransmission ? kMaxDepth + 1u : 1u;

bool counts(vec3 weight) {
    return max(weight.x, max(weight.y, weight.z)) >= kLeastWeight;
}

// The mirrored ray must stay on the surface's side even where the interpolated normal leans over.
real3 mirrored(real3 direction, Surface s) {
    real3 r = reflect(direction, s.normal);
    return dot(r, s.geometricNormal) > 0.0f ? r : reflect(direction, s.geometricNormal);
}

void pushChildren(Pending from, Surface s, inout Pending stack[kStackSize], inout uint stackCount) {
    if (from.depth >= kMaxDepth) return;
    vec3 reflectedWeight = from.weight * s.reflectivity;
    if (kHasTransmission && s.transmission > 0.0f) {
        real3 bent = refract(from.direction, s.normal, real(s.eta));
        vec3 weight = from.weight * s.transmission;
        bool totalReflection = dot(bent, bent) == 0.0f;
        if (totalReflection) {
            reflectedWeight += weight;
        } else if (counts(weight * s.albedo)) {
            // The interpolated normal may bend a grazing ray back to its own side; it then goes straight on.
            real3 through = dot(bent, s.geometricNormal) < 0.0f ? bent : from.direction;
            stack[stackCount++] = Pending(leaveSurface(s, through), through, weight * s.albedo, from.depth + 1u, s.triangle);
        }
    }
    if ((kHasReflection || kHasTransmission) && counts(reflectedWeight)) {
        real3 mirror = mirrored(from.direction, s);
        stack[stackCount++] = Pending(leaveSurface(s, mirror), mirror, reflectedWeight, from.depth + 1u, s.triangle);
    }
}

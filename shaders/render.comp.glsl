// One pixel per invocation: the primary ray and all that follows from it.
#include "formats/shared_types.shared.h"
#include "formats/octahedral.shared.h"
#include "formats/material.shared.h"
#include "formats/atlas.shared.h"
#include "formats/gpu_interface.shared.h"
#include "shaders/features.glsl"
#include "shaders/resources.glsl"
#include "shaders/real.glsl"
#include "shaders/ray.glsl"
#include "shaders/intersect.glsl"
#include "shaders/traverse.glsl"
#include "shaders/surface.glsl"
#include "shaders/shade.glsl"

layout(local_size_x = RT_GROUP_X, local_size_y = RT_GROUP_Y) in;

const real kUnlimited = 1e30f;

real3 pixelDirection(uvec2 pixel) {
    real2 ndc = 2.0f * (real2(pixel) + 0.5f) / real2(picture.size.xy) - 1.0f;
    return normalize(camera.forward.xyz + camera.right.xyz * ndc.x - camera.up.xyz * ndc.y);
}

struct Pixel {
    vec4 color;
    vec4 surface; // N.xyz, Z
    uint id;
};

Pixel renderPixel(real3 direction, inout WorkCounters work) {
    Pixel pixel = Pixel(vec4(0.0f), vec4(0.0f), kNoTriangle);
    Pending stack[kStackSize];
    stack[0] = Pending(real3(camera.eye.xyz), direction, vec3(1.0f), 0u, kNoTriangle);
    uint stackCount = 1u;
    while (stackCount > 0u) {
        Pending current = stack[--stackCount];
        Ray ray = Ray(current.origin, current.direction, 0.0f, kUnlimited);
        Hit hit = trace(ray, false, work);
        if (hit.triangle == kNoTriangle) {
            pixel.color.rgb += current.weight * picture.background.rgb;
            continue;
        }
        if (kCountWork && hit.triangle == current.from) work.selfHits += 1u;
        Surface s = surfaceAt(ray, hit);
        if (current.depth == 0u) {
            real depthWorld = hit.t * dot(direction, real3(camera.forward.xyz)) / grid.worldOffset.w;
            pixel.surface = vec4(vec3(s.normal), float(depthWorld));
            pixel.id = hit.triangle;
            pixel.color.a = 1.0f;
        }
        pixel.color.rgb += current.weight * localLight(s, work);
        pushChildren(current, s, stack, stackCount);
    }
    if (kSoftware && (walkCutShort || stackCount > 0u)) pixel.id = kWalkCutShort;
    return pixel;
}

void main() {
    uvec2 xy = gl_GlobalInvocationID.xy + picture.region.xy;
    if (any(greaterThanEqual(xy, picture.region.zw))) return;
    WorkCounters work = WorkCounters(0u, 0u, 0u, 0u);
    Pixel pixel = renderPixel(pixelDirection(xy), work);
    ivec2 texel = ivec2(xy);
    imageStore(colorImage, texel, pixel.color);
    imageStore(surfaceImage, texel, pixel.surface);
    imageStore(idImage, texel, uvec4(pixel.id));
#if RT_COUNT_WORK
    imageStore(counterImage, texel, uvec4(work.rays, work.steps, work.tests, work.selfHits));
#endif
}

// One pixel per invocation: the primary rays of its samples and all that follows from them.
#include "formats/shared_types.shared.h"
#include "formats/octahedral.shared.h"
#include "formats/material.shared.h"
#include "formats/atlas.shared.h"
#include "formats/gpu_interface.shared.h"
#include "shaders/features.glsl"
#include "shaders/resources.glsl"
#include "shaders/real.glsl"
#include "shaders/ray.glsl"
#include "shaders/random.glsl"
#include "shaders/texture.glsl"
#include "shaders/intersect.glsl"
#include "shaders/traverse.glsl"
#include "shaders/surface.glsl"
#include "shaders/reflectance.glsl"
#include "shaders/environment.glsl"
#include "shaders/lights.glsl"
#include "shaders/view.glsl"
#include "shaders/shade.glsl"

layout(local_size_x = RT_GROUP_X, local_size_y = RT_GROUP_Y) in;

// What one sample of a pixel gives.
struct Sample {
    vec4 color;
    vec4 surface; // N.xyz, Z
    uint id;
    vec3 albedo;
    vec3 position; // world
    vec2 texcoord;
};

// Radiance at the end of a ray that meets no triangle.
vec3 skyRadiance(Pending ray) {
    if (!kHasEnvironment) return picture.background.rgb;
    vec3 direction = vec3(ray.direction);
    float share = ray.density > 0.0f ? ray.density / (ray.density + environmentDensity(direction)) : 1.0f;
    return environmentRadiance(direction) * share;
}

void recordPrimary(inout Sample result, Ray ray, Hit hit, Surface s) {
    real depthWorld = hit.t * (kView == kPanoramaView ? real(1.0f) : dot(ray.direction, real3(camera.forward.xyz))) / grid.worldOffset.w;
    result.surface = vec4(vec3(s.normal), float(depthWorld));
    result.id = hit.triangle;
    result.color.a = 1.0f;
    if (!kHasAovs) return;
    result.albedo = s.baseColor;
    result.position = vec3(s.position / grid.worldOffset.w + real3(grid.worldOffset.xyz));
    result.texcoord = texcoordAt(loadTriangleVertices(hit.triangle), vec3(1.0f - hit.u - hit.v, hit.u, hit.v));
}

// Traces one ray, adds the light that it finds, and makes the rays that follow wait.
void follow(Pending current, Sampler random, inout Sample result, inout WorkCounters work) {
    Ray ray = Ray(current.origin, current.direction, 0.0f, kUnlimited);
    Hit hit = trace(ray, false, work);
    bool missed = hit.triangle == kNoTriangle;
    if (kHasEmitters) {
        Emitter emitter = emitterOnWay(ray, hit.t);
        if (emitter.t < hit.t) {
            float share = current.density > 0.0f ? current.density / (current.density + emitter.density) : 1.0f;
            result.color.rgb += current.weight * passedBy(current.media, float(emitter.t)) * emitter.radiance * share;
            if (current.depth == 0u) result.color.a = 1.0f;
            return;
        }
    }
    if (missed) {
        result.color.rgb += current.weight * skyRadiance(current);
        return;
    }
    if (kCountWork && hit.triangle == current.from) work.selfHits += 1u;
    current.width += float(hit.t) * pixelSpread();
    Surface s = surfaceAt(ray, hit, current.width);
    if (current.depth == 0u) recordPrimary(result, ray, hit, s);
    current.weight *= passedBy(current.media, float(hit.t));
    Scatter c = scatterAt(s, current.direction, current.media);
    result.color.rgb += current.weight * s.opacity * localLight(s, c, current.media, random, current.depth, work);
    if (!s.unlit) pushChildren(current, s, c, random);
}

Sample renderSample(uvec2 pixel, uint index, inout WorkCounters work) {
    Sampler random = samplerOf(pixel, index);
    Sample result = Sample(vec4(0.0f), vec4(0.0f), kNoTriangle, vec3(0.0f), vec3(0.0f), vec2(0.0f));
    Ray primary = pixelRay(pixel, random);
    pending[0] = Pending(primary.origin, primary.direction, vec3(1.0f), pixelWidth(), 0.0f, 0u, kNoTriangle, kNoMedia);
    pendingCount = 1u;
    while (pendingCount > 0u) {
        Pending current = pending[--pendingCount];
        follow(current, random, result, work);
    }
    if (kSoftware && (walkCutShort || pendingCount > 0u)) result.id = kWalkCutShort;
    return result;
}

void main() {
    uvec2 pixel = gl_GlobalInvocationID.xy + picture.region.xy;
    if (any(greaterThanEqual(pixel, picture.region.zw))) return;
    ivec2 texel = ivec2(pixel);
    WorkCounters work = WorkCounters(0u, 0u, 0u, 0u);
    uint first = picture.samples.x;
    vec4 color = first > 0u ? imageLoad(colorImage, texel) : vec4(0.0f);
    vec2 moments = vec2(0.0f);
    vec3 albedo = vec3(0.0f);
#if RT_HAS_MOMENTS
    if (first > 0u) moments = imageLoad(momentImage, texel).xy;
#endif
#if RT_HAS_AOVS
    if (first > 0u) albedo = imageLoad(albedoImage, texel).rgb;
    vec4 texcoord = first > 0u ? imageLoad(texcoordImage, texel) : vec4(0.0f);
#endif
    uint count = kMultisample ? picture.samples.y : 1u;
    for (uint i = 0u; i < count; ++i) {
        Sample one = renderSample(pixel, first + i, work);
        color += one.color;
        float luminance = dot(one.color.rgb, vec3(0.2126f, 0.7152f, 0.0722f));
        moments += vec2(luminance * luminance, luminance);
        albedo += one.albedo;
        if (first + i == 0u || one.id == kWalkCutShort) {
            imageStore(surfaceImage, texel, one.surface);
            imageStore(idImage, texel, uvec4(one.id));
#if RT_HAS_AOVS
            imageStore(positionImage, texel, vec4(one.position, 0.0f));
            texcoord.xy = one.texcoord;
#endif
        }
    }
    imageStore(colorImage, texel, color);
#if RT_HAS_MOMENTS
    imageStore(momentImage, texel, vec4(moments, 0.0f, 0.0f));
#endif
#if RT_HAS_AOVS
    imageStore(albedoImage, texel, vec4(albedo, 0.0f));
    imageStore(texcoordImage, texel, texcoord + vec4(0.0f, 0.0f, float(work.steps), float(work.tests)));
#endif
#if RT_COUNT_WORK
    imageStore(counterImage, texel, uvec4(work.rays, work.steps, work.tests, work.selfHits));
#endif
}

// The primary rays of pixels' samples and all that follows from them: each invocation traces one ray after the other. As soon as a
// sample has no ray left it begins the next, so that lanes whose rays end early do not wait for those whose rays go on (Novak,
// Havran & Dachsbacher 2010); with a queue it then takes the next pixel too.
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
        // A light in the plane of a surface is in front of it.
        Emitter emitter = emitterOnWay(ray, hit.t * (1.0f + 1e-5f), current.gone);
        if (emitter.radiance != vec3(0.0f)) {
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
    current.gone += float(hit.t);
    Surface s = surfaceAt(ray, hit, current.width);
    if (current.depth == 0u) recordPrimary(result, ray, hit, s);
    current.weight *= passedBy(current.media, float(hit.t));
    Scatter c = scatterAt(s, current.direction, current.media);
    result.color.rgb += current.weight * s.opacity * localLight(s, c, current.media, random, current.depth, work);
    pushChildren(current, s, c, random);
}

// Sums over the samples of a pixel, and the sample that is being rendered.
struct PixelWork {
    uvec2 pixel;
    uint index; // of the sample
    Sampler random;
    Sample one;
    vec4 color;
    vec2 moments;
    vec4 albedo; // a: clock ticks
    vec4 texcoord;
    WorkCounters work;
#if RT_HAS_TIME
    uvec2 begun;
#endif
};

#if RT_HAS_TIME
float ticksSince(uvec2 begun) {
    uvec2 now = clock2x32ARB();
    uint borrow;
    uint low = usubBorrow(now.x, begun.x, borrow);
    return 4294967296.0f * float(now.y - begun.y - borrow) + float(low);
}
#endif

uint samplesBehind() { // the first that this dispatch does not take
    return picture.samples.x + (kMultisample ? picture.samples.y : 1u);
}

ivec2 texelOf(uvec2 pixel) {
    return ivec2(pixel - picture.size.zw);
}

PixelWork resumePixel(uvec2 pixel) {
    PixelWork p;
    ivec2 texel = texelOf(pixel);
    p.pixel = pixel;
    p.index = picture.samples.x;
    bool resumed = p.index > 0u;
    p.color = resumed ? imageLoad(colorImage, texel) : vec4(0.0f);
    p.moments = vec2(0.0f);
    p.albedo = vec4(0.0f);
    p.texcoord = vec4(0.0f);
#if RT_HAS_MOMENTS
    if (resumed) p.moments = imageLoad(momentImage, texel).xy;
#endif
#if RT_HAS_AOVS
    if (resumed) p.albedo = imageLoad(albedoImage, texel);
    if (resumed) p.texcoord = imageLoad(texcoordImage, texel);
#endif
    p.work = WorkCounters(0u, 0u, 0u, 0u);
#if RT_HAS_TIME
    p.begun = clock2x32ARB();
#endif
    return p;
}

void beginSample(inout PixelWork p) {
    p.random = samplerOf(p.pixel, p.index);
    p.one = Sample(vec4(0.0f), vec4(0.0f), kNoTriangle, vec3(0.0f), vec3(0.0f), vec2(0.0f));
    Ray primary = pixelRay(p.pixel, p.random);
    pending[0] = Pending(primary.origin, primary.direction, vec3(1.0f), pixelWidth(), 0.0f, 0.0f, 0u, kNoTriangle, kNoMedia);
    pendingCount = 1u;
}

void storeFirstHit(ivec2 texel, Sample one) {
    imageStore(surfaceImage, texel, one.surface);
    imageStore(idImage, texel, uvec4(one.id));
#if RT_HAS_AOVS
    imageStore(positionImage, texel, vec4(one.position, 0.0f));
#endif
}

void endSample(inout PixelWork p) {
    p.color += p.one.color;
    float luminance = dot(p.one.color.rgb, vec3(0.2126f, 0.7152f, 0.0722f));
    p.moments += vec2(luminance * luminance, luminance);
    p.albedo.rgb += p.one.albedo;
    if (p.index == 0u) {
        storeFirstHit(texelOf(p.pixel), p.one);
        p.texcoord.xy = p.one.texcoord;
    }
    ++p.index;
}

void storePixel(PixelWork p) {
    ivec2 texel = texelOf(p.pixel);
    imageStore(colorImage, texel, p.color);
#if RT_HAS_MOMENTS
    imageStore(momentImage, texel, vec4(p.moments, 0.0f, 0.0f));
#endif
#if RT_HAS_TIME
    p.albedo.a += ticksSince(p.begun);
#endif
#if RT_HAS_AOVS
    imageStore(albedoImage, texel, p.albedo);
    imageStore(texcoordImage, texel, p.texcoord + vec4(0.0f, 0.0f, float(p.work.steps), float(p.work.tests)));
#endif
#if RT_COUNT_WORK
    imageStore(counterImage, texel, uvec4(p.work.rays, p.work.steps, p.work.tests, p.work.selfHits));
#endif
}

#if RT_PIXEL_QUEUE
// The queue's pixels in blocks of 8x4, so that lanes begin side by side.
bool nextPixel(out uvec2 pixel) {
    uvec2 size = picture.region.zw - picture.region.xy;
    uvec2 blocks = (size + uvec2(7u, 3u)) / uvec2(8u, 4u);
    for (;;) { // blocks at the border are not full
        uint i = atomicAdd(queuedPixels, 1u);
        uint block = i / 32u, inBlock = i % 32u;
        if (block >= blocks.x * blocks.y) return false;
        uvec2 at = uvec2(block % blocks.x, block / blocks.x) * uvec2(8u, 4u) + uvec2(inBlock % 8u, inBlock / 8u);
        pixel = picture.region.xy + at;
        if (all(lessThan(at, size))) return true;
    }
}
#else
uint takenPixels = 0u;
bool nextPixel(out uvec2 pixel) {
    pixel = gl_GlobalInvocationID.xy + picture.region.xy;
    return takenPixels++ == 0u && all(lessThan(pixel, picture.region.zw));
}
#endif

void main() {
    uvec2 pixel;
    if (!nextPixel(pixel)) return;
    PixelWork p = resumePixel(pixel);
    beginSample(p);
    bool over = false;
    for (;;) {
        Pending current = pending[--pendingCount];
        follow(current, p.random, p.one, p.work);
        if (pendingCount > 0u) continue;
        endSample(p);
        if (p.index == samplesBehind()) {
            storePixel(p);
            if (!nextPixel(pixel)) {
                over = true;
                break;
            }
            p = resumePixel(pixel);
        }
        beginSample(p);
    }
    if (kSoftware && (walkCutShort || !over)) imageStore(idImage, texelOf(p.pixel), uvec4(kWalkCutShort));
}

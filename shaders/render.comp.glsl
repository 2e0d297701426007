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

// Sums over the samples of a pixel, and the sample that is being rendered.
struct PixelWork {
    uvec2 pixel;
    uint index; // of the sample
    Sampler random;
    vec4 sampleColor;
    vec4 color;
    vec2 moments;
    vec3 albedo;
    vec4 texcoord; // of the first sample; steps and tests
    WorkCounters work;
};

// Radiance at the end of a ray that meets no triangle.
vec3 skyRadiance(Pending ray) {
    if (!kHasEnvironment) return picture.background.rgb;
    vec3 direction = vec3(ray.direction);
    float share = ray.density > 0.0f ? ray.density / (ray.density + environmentDensity(direction)) : 1.0f;
    return environmentRadiance(direction) * share;
}

// What a pixel's first sample sees.
void storeFirstHit(uvec2 pixel, vec4 normalAndDepth, uint id, vec3 position) {
    imageStore(surfaceImage, ivec2(pixel), normalAndDepth);
    imageStore(idImage, ivec2(pixel), uvec4(id));
#if RT_HAS_AOVS
    imageStore(positionImage, ivec2(pixel), vec4(position, 0.0f));
#endif
}

void recordPrimary(inout PixelWork p, Ray ray, Hit hit, Surface s) {
    p.sampleColor.a = 1.0f;
    if (kHasAovs) p.albedo += s.baseColor;
    if (p.index > 0u) return;
    real depthWorld = hit.t * (kView == kPanoramaView ? real(1.0f) : dot(ray.direction, real3(camera.forward.xyz))) / grid.worldOffset.w;
    vec3 position = vec3(s.position / grid.worldOffset.w + real3(grid.worldOffset.xyz));
    storeFirstHit(p.pixel, vec4(vec3(s.normal), float(depthWorld)), hit.triangle, position);
    if (kHasAovs) p.texcoord.xy = texcoordAt(loadTriangleVertices(hit.triangle), vec3(1.0f - hit.u - hit.v, hit.u, hit.v));
}

// Adds what a ray of a path brings along without a surface; false if it has met one, which is then lit.
bool endsInLight(Hit hit, inout PixelWork p) {
    bool missed = hit.triangle == kNoTriangle;
    if (kHasEmitters) {
        // A light in the plane of a surface is in front of it.
        Emitter emitter = emitterOnWay(flight.ray, hit.t * (1.0f + 1e-5f), path.gone);
        if (emitter.radiance != vec3(0.0f)) {
            float share = path.density > 0.0f ? path.density / (path.density + emitter.density) : 1.0f;
            p.sampleColor.rgb += path.weight * passedBy(path.media, float(emitter.t)) * emitter.radiance * share;
            if (path.depth == 0u) p.sampleColor.a = 1.0f;
            return true;
        }
    }
    if (missed) p.sampleColor.rgb += path.weight * skyRadiance(path);
    return missed;
}

// Light of the surface itself and around it; rays that go on from it wait.
void beginHit(Surface s, Scatter c, inout PixelWork p) {
    vec3 light = s.unlit ? s.baseColor : s.emission;
    if (!kHasOcclusion && !s.unlit) light += c.diffuse * picture.ambient.rgb;
    p.sampleColor.rgb += path.weight * s.opacity * light;
    pushChildren(path, s, c, p.random);
    bool scatters = largest(c.diffuse) > 0.0f || c.rough;
    job = s.unlit || !scatters ? jobCount() : 0u;
}

// Whether the flight was one of a path and has met a surface, or one to a light behind which there may be others to ask.
void land(Hit hit, inout PixelWork p, inout bool fresh, inout bool flying) {
    bool missed = hit.triangle == kNoTriangle;
    if (flight.shadow) {
        if (missed) p.sampleColor.rgb += arrivedLight();
        else flying = goesOn(hit);
    } else if (endsInLight(hit, p)) {
        job = jobCount();
    } else {
        lit = hit;
        job = 0u;
        fresh = true;
        path.width += float(hit.t) * pixelSpread();
        path.gone += float(hit.t);
    }
}

// Takes a hit and finds the sample's next ray; false if it has none.
bool follow(Hit hit, inout PixelWork p) {
    bool fresh = false, flying = false;
    land(hit, p, fresh, flying);
    if (!flying && (fresh || job < jobCount())) {
        Ray ray = Ray(path.origin, path.direction, 0.0f, kUnlimited);
        Surface s = surfaceAt(ray, lit, path.width);
        if (fresh) path.weight *= passedBy(path.media, float(lit.t));
        Scatter c = scatterAt(s, path.direction, path.media);
        if (fresh) {
            if (path.depth == 0u) recordPrimary(p, ray, lit, s);
            beginHit(s, c, p);
        }
        if (job < jobCount()) flying = nextShadow(s, c, p.random);
    }
    if (!flying && pendingCount > 0u) {
        fly(pending[--pendingCount]);
        flying = true;
    }
    return flying;
}

uint samplesBehind() { // the first that this dispatch does not take
    return picture.samples.x + (kMultisample ? picture.samples.y : 1u);
}

PixelWork resumePixel(uvec2 pixel) {
    PixelWork p;
    ivec2 texel = ivec2(pixel);
    p.pixel = pixel;
    p.index = picture.samples.x;
    bool resumed = p.index > 0u;
    p.color = resumed ? imageLoad(colorImage, texel) : vec4(0.0f);
    p.moments = vec2(0.0f);
    p.albedo = vec3(0.0f);
    p.texcoord = vec4(0.0f);
#if RT_HAS_MOMENTS
    if (resumed) p.moments = imageLoad(momentImage, texel).xy;
#endif
#if RT_HAS_AOVS
    if (resumed) p.albedo = imageLoad(albedoImage, texel).rgb;
    if (resumed) p.texcoord = imageLoad(texcoordImage, texel);
#endif
    p.work = WorkCounters(0u, 0u, 0u, 0u);
    return p;
}

void beginSample(inout PixelWork p) {
    p.random = samplerOf(p.pixel, p.index);
    p.sampleColor = vec4(0.0f);
    if (p.index == 0u) storeFirstHit(p.pixel, vec4(0.0f), kNoTriangle, vec3(0.0f));
    Ray primary = pixelRay(p.pixel, p.random);
    fly(Pending(primary.origin, primary.direction, vec3(1.0f), pixelWidth(), 0.0f, 0.0f, 0u, kNoTriangle, kNoMedia));
    pendingCount = 0u;
}

void endSample(inout PixelWork p) {
    p.color += p.sampleColor;
    float luminance = dot(p.sampleColor.rgb, vec3(0.2126f, 0.7152f, 0.0722f));
    p.moments += vec2(luminance * luminance, luminance);
    ++p.index;
}

void storePixel(PixelWork p) {
    ivec2 texel = ivec2(p.pixel);
    imageStore(colorImage, texel, p.color);
#if RT_HAS_MOMENTS
    imageStore(momentImage, texel, vec4(p.moments, 0.0f, 0.0f));
#endif
#if RT_HAS_AOVS
    imageStore(albedoImage, texel, vec4(p.albedo, 0.0f));
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
    while (!over) {
        Hit hit = trace(flight.ray, flight.anyHit, p.work);
        if (kCountWork && hit.triangle == flight.from && flight.from != kNoTriangle) p.work.selfHits += 1u;
        if (!follow(hit, p)) {
            endSample(p);
            bool more = true;
            if (p.index == samplesBehind()) {
                storePixel(p);
                more = nextPixel(pixel);
                if (more) p = resumePixel(pixel);
            }
            if (more) beginSample(p);
            else over = true;
        }
    }
    if (kSoftware && (walkCutShort || !over)) imageStore(idImage, ivec2(p.pixel), uvec4(kWalkCutShort));
}

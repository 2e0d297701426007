// What rt-trace's host code and its shaders agree on beyond the atlas: bindings, parameters, rays, hits.
#ifndef RT_GPU_INTERFACE_H
#define RT_GPU_INTERFACE_H
#ifdef __cplusplus
#include "formats/shared_types.shared.h"
#endif

RT_SHARED_BEGIN

// Uniform blocks.
#define RT_BINDING_GRID 0   // GridParams
#define RT_BINDING_CAMERA 1 // CameraParams (render)
#define RT_BINDING_QUERY 1  // QueryParams (query)
#define RT_BINDING_RENDER 2 // RenderParams (render)
// Image units. Sums are over a pixel's samples so far; what has no sum is that of its first sample.
#define RT_IMAGE_COLOR 0    // rgba32f: sum of linear RGB; A: samples whose primary ray hit
#define RT_IMAGE_SURFACE 1  // rgba32f: N.xyz, Z
#define RT_IMAGE_ID 2       // r32ui: triangle index or kNoTriangle
#define RT_IMAGE_COUNTERS 3 // rgba32ui, where work is counted: see WorkCounters in shaders/ray.glsl
#define RT_IMAGE_MOMENTS                                                                                     \
    4 // rg32f, where the error is estimated: sum of the luminance squared, of the luminance
#define RT_IMAGE_ALBEDO 5 // rgba32f, where AOVs are wanted: sum of the albedo; A: of the clock's ticks, or 0
#define RT_IMAGE_POSITION 6 // rgba32f, where AOVs are wanted: P.xyz, world; A = 0
#define RT_IMAGE_TEXCOORD 7 // rgba32f, where AOVs are wanted: U, V; sums of steps and tests of all rays
// Storage buffers that are never split. Atlas arrays that may need several buffers take the numbers from
// RT_BUFFER_FIRST_PAGED on, in the order of the host's table (tools/rt-trace/shader_resources).
#define RT_BUFFER_QUEUE 0     // query, scattered rays: uint, the next ray's index
#define RT_BUFFER_MATERIALS 0 // render
#define RT_BUFFER_LIGHTS 1    // Light, in atlas space
#define RT_BUFFER_IMAGES 2
#define RT_BUFFER_RAYS 3
#define RT_BUFFER_ENVIRONMENT 3 // render: float, see kEnvironmentRows
#define RT_BUFFER_HITS 4
#define RT_BUFFER_SLOTS 4    // render: uvec4, see SlotLayout in tools/rt-trace/sample_slots.h
#define RT_BUFFER_COUNTERS 5 // uvec4 per ray, where work is counted
#define RT_BUFFER_ROUNDS                                                                                     \
    5 // render: TraceRound times kRoundsInGroup + 1; uint: slots with a ray for this round, and for the next
#define RT_BUFFER_FIRST_PAGED 6
// Texture units: the texture pages, once with sRGB decoded and once as they are; the environment; with
// --kernel multipass the rays; then the slabs of the voxel texture.
#define RT_TEXTURE_PAGES 0
#define RT_TEXTURE_LINEAR_PAGES 1
#define RT_TEXTURE_ENVIRONMENT 2
#define RT_TEXTURE_FIRST_VOXELS 3 // without rays
// rgba32ui, a ray of each pixel: planes of SlotLayout in tools/rt-trace/slot_layout.h but for the one that
// says how far the ray has come, see Progress in shaders/pass.glsl.
#define RT_TEXTURE_FIRST_RAYS 3
#define RT_TEXTURE_COLOR 3
#define RT_TEXTURE_ORIGIN 4
#define RT_TEXTURE_DIRECTION 5
#define RT_TEXTURE_PROGRESS 6
#define RT_TEXTURE_HIT 7

RT_SHARED_CONST uint kRayTextureCount = 5u;

RT_SHARED_CONST uint kNoTriangle = 0xFFFFFFFFu;
RT_SHARED_CONST uint kWalkCutShort = 0xFFFFFFFEu; // instead of a triangle: the device ended a loop too early

// Triangle tests.
RT_SHARED_CONST uint kIntersectWatertight = 0u;     // Woop, Benthin & Wald 2013
RT_SHARED_CONST uint kIntersectMollerTrumbore = 1u; // 1997
RT_SHARED_CONST uint kIntersectBaldwinWeber = 2u;   // 2016

// Kinds of views: those of the cameras that files hold, by the same numbers (formats/mesh.h), and one more.
RT_SHARED_CONST uint kPerspectiveView = 0u;
RT_SHARED_CONST uint kOrthographicView = 1u;
RT_SHARED_CONST uint kPanoramaView = 2u;

// A camera in atlas space. With x = 2 (column + 0.5) / width - 1 and y = 1 - 2 (row + 0.5) / height, row 0 at
// the top, the ray through a point of the picture is
//     perspective   from eye along forward + right * x + up * y
//     orthographic  from eye + right * x + up * y along forward
//     panorama      from eye, turned by pi * x about up from forward to right, and up by pi / 2 * y; the
//     axes' lengths do not count
// A lens moves a perspective ray's origin by up to lensRadius along right and up; it still meets its point at
// focusDistance.
struct CameraParams {
    vec4 eye;     // xyz; w lens radius
    vec4 right;   // xyz half the picture's width: perspective at distance 1; w = 0
    vec4 up;      // xyz half the picture's height; w = 0
    vec4 forward; // xyz unit length; w distance along it of the plane in focus
};

// What is rendered by one dispatch, and in which light.
struct RenderParams {
    vec4 background; // rgb radiance of rays that leave the scene, if there is no environment; w = 0
    vec4 ambient; // rgb radiance that every surface receives; w distance within which surfaces hide it, 0 =
                  // nothing does
    vec4 environment; // rgb factor of the environment's radiance; w its turn about +y, in turns
    vec4 filterSize;  // x radius of the reconstruction filter, pixels; yzw = 0
    uvec4 size;       // width and height of the whole picture; the pixel x, y that is the images' first
    uvec4 region;     // first pixel x, y of this dispatch; first pixel behind it x, y
    uvec4 samples;    // first sample of this dispatch, how many, seed, kind of filter kFilter...
    uvec4 slots;      // x how many samples there is room for; yzw = 0
};

// Rounds trace one ray of each sample of a batch that has one; all those of a group are dispatched before the
// host looks whether there are samples left.
RT_SHARED_CONST uint kRoundsInGroup = 32u;
struct TraceRound {
    uvec4 groups; // xyz work groups, for an indirect dispatch; w = 0
    uvec4 counts; // in the round's queue: x rays of paths from its front, y shadow rays from its end; zw = 0
};
// --kernel multipass: depths say which pass has something to do at a pixel, so that the device can leave it
// out before a shader runs. Intersect and shade want those behind their own depth; shade leaves its own
// there.
RT_SHARED_CONST float kDepthNothing = 0.0f; // no ray, or in a voxel without triangles
RT_SHARED_CONST float kDepthOfIntersect = 0.25f;
RT_SHARED_CONST float kDepthTriangles = 0.5f; // in a voxel with triangles
RT_SHARED_CONST float kDepthOfShade = 0.75f;
RT_SHARED_CONST float kDepthLanded = 1.0f; // the walk is over
// What a dispatch of the renderer does.
RT_SHARED_CONST uint kStageBegin = 0u;   // a batch: its first round
RT_SHARED_CONST uint kStageAdvance = 1u; // another round
RT_SHARED_CONST uint kStageResolve = 2u; // samples are added to their pixels
#define RT_LOCATION_STAGE 0              // uniforms
#define RT_LOCATION_ROUND 1              // of its group

RT_SHARED_CONST uint kFilterBox = 0u;
RT_SHARED_CONST uint kFilterTent = 1u;
RT_SHARED_CONST uint kFilterGaussian = 2u; // sigma is a third of the radius
RT_SHARED_CONST uint kFilterBlackmanHarris = 3u;

// How the environment's light is distributed, in floats: its width, its height, its integral, from here on
// for each border of rows the part of the light above it, then for each row the same of its columns' borders,
// left of them (tools/rt-trace/environment.h).
RT_SHARED_CONST uint kEnvironmentRows = 3u;

// Where the borders in a row begin.
RT_SHARED_FN uint environmentRow(uint width, uint height, uint row) {
    return kEnvironmentRows + height + 1u + row * (width + 1u);
}

struct QueryParams {
    uvec4 count; // x rays of this dispatch; y the most that a lane takes (scattered rays); zw = 0
};

// Rays and hits are the raw float32 records of the --rays and -o files. Directions need not be normalized.
struct QueryRay {
    vec4 originTmin;    // world space
    vec4 directionTmax; // world space
};
struct QueryHit {
    uvec4 tuvId; // float bits of t (world; -1 = miss), u, v; triangle index or kNoTriangle
};

// Rows of the affine map that takes a triangle's plane to z = 0 and its corners to (0,0), (1,0) and (0,1).
struct TriangleTransform {
    vec4 u;
    vec4 v;
    vec4 plane;
};
struct TriangleTransformDouble {
    dvec4 u;
    dvec4 v;
    dvec4 plane;
};

struct QueryHitDouble {
    double t, u, v; // world; t = -1: miss
    uint triangle;  // index or kNoTriangle
    uint zero;
};

RT_SHARED_END

#ifdef __cplusplus
static_assert(sizeof(rt::CameraParams) == 64 && sizeof(rt::QueryParams) == 16);
static_assert(sizeof(rt::RenderParams) == 128 && offsetof(rt::RenderParams, samples) == 96);
static_assert(sizeof(rt::QueryRay) == 32 && sizeof(rt::QueryHit) == 16);
static_assert(sizeof(rt::QueryHitDouble) == 32 && offsetof(rt::QueryHitDouble, triangle) == 24);
static_assert(sizeof(rt::TriangleTransform) == 48 && offsetof(rt::TriangleTransform, v) == 16 &&
              offsetof(rt::TriangleTransform, plane) == 32);
static_assert(sizeof(rt::TriangleTransformDouble) == 96 && offsetof(rt::TriangleTransformDouble, v) == 32 &&
              offsetof(rt::TriangleTransformDouble, plane) == 64);
static_assert(offsetof(rt::QueryRay, directionTmax) == 16);
#endif
#endif

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
// Image units.
#define RT_IMAGE_COLOR 0    // rgba32f: linear RGB, A = 1 where the primary ray hit
#define RT_IMAGE_SURFACE 1  // rgba32f: N.xyz, Z
#define RT_IMAGE_ID 2       // r32ui: triangle index or kNoTriangle
#define RT_IMAGE_COUNTERS 3 // rgba32ui, where work is counted: see WorkCounters in shaders/ray.glsl
// Storage buffers that are never split. Atlas arrays that may need several buffers take the numbers from
// RT_BUFFER_FIRST_PAGED on, in the order of the host's table (tools/rt-trace/shader_resources).
#define RT_BUFFER_QUEUE 0     // query, scattered rays: uint, the next ray's index
#define RT_BUFFER_MATERIALS 0 // render
#define RT_BUFFER_LIGHTS 1    // AtlasLight
#define RT_BUFFER_IMAGES 2
#define RT_BUFFER_RAYS 3
#define RT_BUFFER_HITS 4
#define RT_BUFFER_COUNTERS 5 // uvec4 per ray, where work is counted
#define RT_BUFFER_FIRST_PAGED 6
// Texture units: the texture pages, then the slabs of the voxel texture.
#define RT_TEXTURE_PAGES 0
#define RT_TEXTURE_FIRST_VOXELS 1

RT_SHARED_CONST uint kNoTriangle = 0xFFFFFFFFu;
RT_SHARED_CONST uint kWalkCutShort = 0xFFFFFFFEu; // instead of a triangle: the device ended a loop too early

// Triangle tests.
RT_SHARED_CONST uint kIntersectWatertight = 0u;     // Woop, Benthin & Wald 2013
RT_SHARED_CONST uint kIntersectMollerTrumbore = 1u; // 1997
RT_SHARED_CONST uint kIntersectBaldwinWeber = 2u;   // 2016

// A pinhole camera in atlas space; the ray through pixel (x, y), (0, 0) = top left, is
//     forward + right * (2 (x + 0.5) / width - 1) + up * (1 - 2 (y + 0.5) / height), normalized.
struct CameraParams {
    vec4 eye;        // xyz atlas space; w = 0
    vec4 right;      // xyz half the image's width at distance 1; w = 0
    vec4 up;         // xyz half the image's height at distance 1; w = 0
    vec4 forward;    // xyz unit length; w = 0
    vec4 background; // rgb radiance of rays that leave the scene; w = 0
    vec4 ambient;    // rgb radiance that every surface receives, unshadowed; w = 0
    uvec4 size;      // width, height, first row of this dispatch, 0
};

struct QueryParams {
    uvec4 count; // x rays of this dispatch; y the most that a lane takes (scattered rays); zw = 0
};

// A point light as the shaders want it: distances are in atlas units, so intensities are those of the world
// times the square of the scale.
struct AtlasLight {
    vec4 positionAtlas;  // xyz; w = 0
    vec4 intensityAtlas; // rgb; w = 0
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
static_assert(sizeof(rt::CameraParams) == 112 && sizeof(rt::QueryParams) == 16);
static_assert(sizeof(rt::AtlasLight) == 32 && offsetof(rt::AtlasLight, intensityAtlas) == 16);
static_assert(sizeof(rt::QueryRay) == 32 && sizeof(rt::QueryHit) == 16);
static_assert(sizeof(rt::QueryHitDouble) == 32 && offsetof(rt::QueryHitDouble, triangle) == 24);
static_assert(sizeof(rt::TriangleTransform) == 48 && offsetof(rt::TriangleTransform, v) == 16 &&
              offsetof(rt::TriangleTransform, plane) == 32);
static_assert(sizeof(rt::TriangleTransformDouble) == 96 && offsetof(rt::TriangleTransformDouble, v) == 32 &&
              offsetof(rt::TriangleTransformDouble, plane) == 64);
static_assert(offsetof(rt::CameraParams, size) == 96 && offsetof(rt::QueryRay, directionTmax) == 16);
#endif
#endif

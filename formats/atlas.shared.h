// The acceleration structure and the geometry of an atlas as the shaders read them (std140 / std430).
#ifndef RT_ATLAS_SHARED_H
#define RT_ATLAS_SHARED_H
#ifdef __cplusplus
#include "formats/shared_types.shared.h"
#endif

RT_SHARED_BEGIN

// Atlas space is world space moved and scaled so that the scene is near the origin and about unit size:
//     atlas = (world - offset) * scale,   world = atlas / scale + offset.
// The scale is a power of two and the offset is chosen so that no vertex is rounded. Directions are scaled
// too, so a ray's parameter t is the same number in both spaces.

// Structure kinds: what the word of an empty voxel says. A word of an occupied voxel has bit 31 set in all of
// them.
RT_SHARED_CONST uint kStructureUniform = 0u; // 0
RT_SHARED_CONST uint kStructureCloud =
    1u; // chessboard distance, in voxels, to the nearest occupied voxel (>= 1)
RT_SHARED_CONST uint kStructureOctant = 2u; // reserved
RT_SHARED_CONST uint kStructureNested = 3u; // reserved

RT_SHARED_CONST uint kOccupiedBit = 0x80000000u; // the other 31 bits: offset of the voxel's list in REFS

struct GridParams {
    vec4 gridLo;       // xyz corner of voxel (0,0,0), atlas space; w = 0
    vec4 cellSize;     // xyz atlas units per voxel; w = 0
    vec4 cellsPerUnit; // xyz 1 / cellSize; w = 0
    vec4 worldOffset;  // xyz offset, world units; w scale (atlas units per world unit, a power of two)
    uvec4 dims;        // xyz voxels per axis; w structure kind
    uvec4 counts;      // x triangles, y vertices, z materials, w lights
};

// A triangle ready to test; the bits of v0.w are its index in the imported file's order.
struct TriangleRecord {
    vec4 v0;
    vec4 v1; // w = 0
    vec4 v2; // w = 0
};

RT_SHARED_END

#ifdef __cplusplus
static_assert(sizeof(rt::GridParams) == 96 && sizeof(rt::TriangleRecord) == 48);
static_assert(offsetof(rt::GridParams, cellSize) == 16 && offsetof(rt::GridParams, cellsPerUnit) == 32);
static_assert(offsetof(rt::GridParams, worldOffset) == 48 && offsetof(rt::GridParams, dims) == 64);
static_assert(offsetof(rt::GridParams, counts) == 80);
static_assert(offsetof(rt::TriangleRecord, v1) == 16 && offsetof(rt::TriangleRecord, v2) == 32);
#endif
#endif

// The acceleration structure and the geometry of an atlas as the shaders read them (std140 / std430).
#ifndef RT_ATLAS_SHARED_H
#define RT_ATLAS_SHARED_H
#ifdef __cplusplus
#include "formats/shared_types.shared.h"

#include <glm/integer.hpp>
#endif

RT_SHARED_BEGIN

#ifdef __cplusplus
using glm::findMSB;
#endif

// Atlas space is world space moved and scaled so that the scene is near the origin and about unit size:
//     atlas = (world - offset) * scale,   world = atlas / scale + offset.
// The scale is a power of two and the offset is chosen so that no vertex is rounded. Directions are scaled
// too, so a ray's parameter t is the same number in both spaces.

// Structure kinds: what the word of an empty voxel says. A word of an occupied voxel has bit 31 set in all of
// them.
RT_SHARED_CONST uint kStructureUniform = 0u; // 0
RT_SHARED_CONST uint kStructureCloud =
    1u; // chessboard distance, in voxels, to the nearest occupied voxel (>= 1)
RT_SHARED_CONST uint kStructureOctant = 2u; // how far it is free to each of the six sides: an empty box
RT_SHARED_CONST uint kStructureNested = 3u; // an empty box; crowded voxels hold bricks of finer voxels

RT_SHARED_FN bool hasBoxes(uint structure) {
    return structure >= kStructureOctant;
}

// A word of VOXL, or of a brick in BRIK, is one of
//     empty  0 ... as the structure kind says; a box is
//            00 hi.z lo.z hi.y lo.y hi.x lo.x   six numbers of 5 bits, lo.x lowest: how many voxels beyond
//                                               this one, and of its size, are free of triangles on that side
//     leaf   10 offset:30                       its list in REFS
//     brick  11 k:3 offset:27                   (2^k)^3 words in BRIK from word 8 * offset on, x fastest
// from bit 31 down. A box may cross the borders of bricks and of VOXL's voxels, and may leave the grid.
// A list is an exit box, a word like an empty voxel's: a ray that has tested the list may leave that box; 0
// is the voxel alone. Then follow the indices of the list's triangles, at least one, ascending; the last one
// has kLastInList set.
RT_SHARED_CONST uint kOccupiedBit = 0x80000000u;
RT_SHARED_CONST uint kBrickTag = 0xC0000000u;  // words from this one on are bricks
RT_SHARED_CONST uint kMaxBrickShift = 5u;      // k
RT_SHARED_CONST uint kMaxFinestSide = 524288u; // voxels of the finest size along any side of the grid
RT_SHARED_CONST uint kListHeaderWords = 1u;    // the exit box
RT_SHARED_CONST uint kLastInList = 0x80000000u;

RT_SHARED_FN bool isBrick(uint word) {
    return word >= kBrickTag;
}
RT_SHARED_FN uint leafWord(uint listOffset) {
    return kOccupiedBit | listOffset;
}
RT_SHARED_FN uint leafList(uint word) {
    return word & 0x3FFFFFFFu;
}
RT_SHARED_FN uint brickWord(uint offset, int shift) {
    return kBrickTag | (uint(shift) << 27u) | (offset >> 3u);
}
RT_SHARED_FN uint brickOffset(uint word) {
    return (word & 0x07FFFFFFu) << 3u;
}
RT_SHARED_FN int brickShift(uint word) {
    return int((word >> 27u) & 7u);
}
RT_SHARED_FN ivec3 freeBelow(uint word) {
    return ivec3(int(word & 31u), int((word >> 10u) & 31u), int((word >> 20u) & 31u));
}
RT_SHARED_FN ivec3 freeAbove(uint word) {
    return freeBelow(word >> 5u);
}
RT_SHARED_FN uint freeBoxWord(ivec3 below, ivec3 above) {
    return uint(below.x) | (uint(above.x) << 5u) | (uint(below.y) << 10u) | (uint(above.y) << 15u) |
           (uint(below.z) << 20u) | (uint(above.z) << 25u);
}

// Voxels are at most 2^this times smaller than those of a nested grid of so many along its longest side.
RT_SHARED_FN int finestLevelOf(uint longestSide) {
    return findMSB(kMaxFinestSide) - 1 - findMSB(longestSide - 1u); // findMSB(0) is -1
}

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
    vec4 v1; // w = 1: a sliver, whose plane would put hits off by more than 2^-8 of the scene; else 0
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

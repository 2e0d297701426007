// Surfaces, lights and image places as the files hold them and as the shaders read them (std430).
#ifndef RT_MATERIAL_H
#define RT_MATERIAL_H
#ifdef __cplusplus
#include "formats/shared_types.shared.h"
#endif

RT_SHARED_BEGIN

RT_SHARED_CONST uint kNoImage = 0xFFFFFFFFu;

// Of the light that meets a surface, `mirror` is reflected as by a perfect mirror. Of the rest, `metallic` is
// met by metal, which reflects baseColor (Schlick 1994), and the rest of it by a dielectric, which reflects
// `specular` of what Fresnel's equations say, lets `transmission` of what is left through and scatters what
// is then left diffusely.
struct Material {
    vec4 baseColor;  // rgb linear 0..1, multiplied by the image's; a opacity 0..1, multiplied by the image's
                     // alpha
    vec4 emission;   // rgb radiance, multiplied by the image's; a = 0
    vec4 reflection; // x metallic, y roughness, z specular, w mirror; all 0..1
    vec4 transmission; // x transmission 0..1; y index of refraction 1..100; z distance, in world units, after
                       // which light that was white is of the colour below, 0 = never; w opacity below which
                       // nothing is there, 0 = opacity is the part of the light that is stopped
    vec4 attenuation;  // rgb 0..1 inside the material; w strength of the normal image
    uvec4 images; // base colour and opacity; roughness (G) and metallic (B); normals; emission: each an image
                  // or kNoImage
    uvec4 more;   // x image of transmission (R) or kNoImage; y bits kMaterial...; zw = 0
};

RT_SHARED_CONST uint kMaterialThin = 1u;  // a wall without a thickness: light goes straight through
RT_SHARED_CONST uint kMaterialUnlit = 2u; // shows its base colour, whatever the light
RT_SHARED_CONST uint kMaterialClear = 4u; // its opacity counts; else it is opaque whatever alpha says
RT_SHARED_CONST uint kMaterialBits = 7u;  // all of them

RT_SHARED_CONST uint kLightPoint = 0u;
RT_SHARED_CONST uint kLightDirectional = 1u;
RT_SHARED_CONST uint kLightSpot = 2u;
RT_SHARED_CONST uint kLightRectangle = 3u;
RT_SHARED_CONST uint kLightSphere = 4u;
RT_SHARED_CONST uint kLightKindCount = 5u;

// A white diffuse surface that faces a light at distance d has the radiance intensity / (pi d^2) from a point
// or a spot, intensity / pi from a directional light. A rectangle or a sphere has the radiance `intensity`
// itself; a rectangle shines to the side that `direction` says. In .rtmesh and .rtatlas world space; rt-trace
// moves them to atlas space, where distances, and the intensities of points and spots, have other values.
struct Light {
    vec4 position;  // xyz; of the centre of a rectangle or sphere; w radius of a sphere
    vec4 intensity; // rgb >= 0; w = 0
    vec4 direction; // xyz unit length, the way that light goes: directional, spot, rectangle; w cosine of a
                    // spot's outer half angle
    vec4 edgeU;     // xyz from a rectangle's centre to the middle of an edge; w cosine of a spot's inner half
                    // angle
    vec4 edgeV;     // xyz the same for the next edge, at a right angle; w = 0
    uvec4 kind;     // x kLight...; yzw = 0
};

RT_SHARED_CONST uint kWrapRepeat = 0u;
RT_SHARED_CONST uint kWrapClamp = 1u;
RT_SHARED_CONST uint kWrapMirror = 2u;

RT_SHARED_CONST uint kImageSrgb = 0u;   // colours; alpha is linear
RT_SHARED_CONST uint kImageLinear = 1u; // numbers: roughness, normals

// Where an image lies in the texture pages of an atlas. Texel row 0 is the image's top row; v = 0 is its
// bottom edge. Its smaller levels stand at its right: see levelRect().
struct ImagePlace {
    uvec4 rect; // x, y of the top left texel in its page; width, height
    uvec4 page; // x page (layer of the 2D array), y wrap of u, z wrap of v, w kImageSrgb or kImageLinear
};

// Levels of an image, down to 1x1: each is half as wide and high, rounded down, at least 1.
RT_SHARED_FN uint levelSide(uint side, uint level) {
    uint smaller = side >> level;
    return smaller > 0u ? smaller : 1u;
}

// x, y, width and height of a level: level 1 stands right of level 0, the next ones below it, one under the
// other.
RT_SHARED_FN uvec4 levelRect(uvec4 rect, uint level) {
    if (level == 0u) return rect;
    uint y = rect.y;
    for (uint k = 1u; k < level; ++k) y += levelSide(rect.w, k);
    return uvec4(rect.x + rect.z, y, levelSide(rect.z, level), levelSide(rect.w, level));
}

// Width and height of an image with its levels.
RT_SHARED_FN uvec2 extentWithLevels(uint width, uint height) {
    if (width == 1u && height == 1u) return uvec2(1u, 1u);
    uint below = 0u;
    for (uint k = 1u; (width >> (k - 1u)) > 1u || (height >> (k - 1u)) > 1u; ++k)
        below += levelSide(height, k);
    return uvec2(width + levelSide(width, 1u), height > below ? height : below);
}

RT_SHARED_END

#ifdef __cplusplus
static_assert(sizeof(rt::Material) == 112 && sizeof(rt::Light) == 96 && sizeof(rt::ImagePlace) == 32);
static_assert(offsetof(rt::Material, emission) == 16 && offsetof(rt::Material, reflection) == 32);
static_assert(offsetof(rt::Material, transmission) == 48 && offsetof(rt::Material, attenuation) == 64);
static_assert(offsetof(rt::Material, images) == 80 && offsetof(rt::Material, more) == 96);
static_assert(offsetof(rt::Light, intensity) == 16 && offsetof(rt::Light, direction) == 32);
static_assert(offsetof(rt::Light, edgeU) == 48 && offsetof(rt::Light, edgeV) == 64 &&
              offsetof(rt::Light, kind) == 80);
static_assert(offsetof(rt::ImagePlace, page) == 16);
#endif
#endif

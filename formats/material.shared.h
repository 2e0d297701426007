// Surfaces, lights and image places as the files hold them and as the shaders read them (std430).
#ifndef RT_MATERIAL_H
#define RT_MATERIAL_H
#ifdef __cplusplus
#include "formats/shared_types.shared.h"
#endif

RT_SHARED_BEGIN

RT_SHARED_CONST uint kNoImage = 0xFFFFFFFFu;

struct Material {
    vec4 baseColor; // rgb linear, multiplied by the base-colour image; a = 1
    vec4 emission;  // rgb radiance; a = 0
    vec4 optics;  // x reflectivity 0..1, y transmission 0..1 (x + y <= 1), z index of refraction >= 1, w = 0
    uvec4 images; // x base-colour image or kNoImage; yzw = kNoImage
};

// A point light. Radiance of a white diffuse surface facing it at distance d: intensity / (pi d^2).
struct Light {
    vec4 positionWorld; // xyz; w = 0
    vec4 intensity;     // rgb; w = 0
};

RT_SHARED_CONST uint kWrapRepeat = 0u;
RT_SHARED_CONST uint kWrapClamp = 1u;
RT_SHARED_CONST uint kWrapMirror = 2u;

// Where an image lies in the texture pages of an atlas. Texel row 0 is the image's top row; v = 0 is its
// bottom edge.
struct ImagePlace {
    uvec4 rect; // x, y of the top left texel in its page; width, height
    uvec4 page; // x page (layer of the 2D array), y wrap of u, z wrap of v, w = 0
};

RT_SHARED_END

#ifdef __cplusplus
static_assert(sizeof(rt::Material) == 64 && sizeof(rt::Light) == 32 && sizeof(rt::ImagePlace) == 32);
static_assert(offsetof(rt::Material, emission) == 16 && offsetof(rt::Material, optics) == 32);
static_assert(offsetof(rt::Material, images) == 48 && offsetof(rt::Light, intensity) == 16);
static_assert(offsetof(rt::ImagePlace, page) == 16);
#endif
#endif

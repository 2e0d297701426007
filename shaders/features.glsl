// The features that this variant was compiled for. The host defines every macro (tools/rt-trace/scene_features); code
// below says `if (kHas...)`, and the compiler drops what is off.
#ifndef RT_STRUCTURE
#error "RT_STRUCTURE is not defined"
#endif
#ifndef RT_DOUBLE
#error "RT_DOUBLE is not defined"
#endif
#ifndef RT_INTERSECT
#error "RT_INTERSECT is not defined"
#endif
#ifndef RT_ANY_HIT
#error "RT_ANY_HIT is not defined"
#endif
#ifndef RT_SCATTERED_RAYS
#error "RT_SCATTERED_RAYS is not defined"
#endif
#ifndef RT_SUBGROUPS
#error "RT_SUBGROUPS is not defined"
#endif
#ifndef RT_SOFTWARE
#error "RT_SOFTWARE is not defined"
#endif
#ifndef RT_COUNT_WORK
#error "RT_COUNT_WORK is not defined"
#endif
#ifndef RT_HAS_SLIVERS
#error "RT_HAS_SLIVERS is not defined"
#endif
#ifndef RT_HAS_TEXTURES
#error "RT_HAS_TEXTURES is not defined"
#endif
#ifndef RT_HAS_REFLECTION
#error "RT_HAS_REFLECTION is not defined"
#endif
#ifndef RT_HAS_TRANSMISSION
#error "RT_HAS_TRANSMISSION is not defined"
#endif
#ifndef RT_HAS_EMISSION
#error "RT_HAS_EMISSION is not defined"
#endif
#ifndef RT_HAS_LIGHTS
#error "RT_HAS_LIGHTS is not defined"
#endif
#ifndef RT_MAX_DEPTH
#error "RT_MAX_DEPTH is not defined"
#endif

const uint kStructure = uint(RT_STRUCTURE);
const bool kDouble = RT_DOUBLE != 0;
const uint kIntersect = uint(RT_INTERSECT);
const bool kAnyHit = RT_ANY_HIT != 0;
const bool kScatteredRays = RT_SCATTERED_RAYS != 0; // the host then takes query_scattered.comp.glsl
const bool kSubgroups = RT_SUBGROUPS != 0;
const bool kSoftware = RT_SOFTWARE != 0;
const bool kCountWork = RT_COUNT_WORK != 0;
const bool kHasSlivers = RT_HAS_SLIVERS != 0;
const bool kHasTextures = RT_HAS_TEXTURES != 0;
const bool kHasReflection = RT_HAS_REFLECTION != 0;
const bool kHasTransmission = RT_HAS_TRANSMISSION != 0;
const bool kHasEmission = RT_HAS_EMISSION != 0;
const bool kHasLights = RT_HAS_LIGHTS != 0;
const uint kMaxDepth = uint(RT_MAX_DEPTH);

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
#ifndef RT_MULTIPASS
#error "RT_MULTIPASS is not defined"
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
#ifndef RT_HAS_NORMAL_IMAGES
#error "RT_HAS_NORMAL_IMAGES is not defined"
#endif
#ifndef RT_HAS_CUTOUTS
#error "RT_HAS_CUTOUTS is not defined"
#endif
#ifndef RT_HAS_OPACITY
#error "RT_HAS_OPACITY is not defined"
#endif
#ifndef RT_HAS_REFLECTION
#error "RT_HAS_REFLECTION is not defined"
#endif
#ifndef RT_HAS_ROUGHNESS
#error "RT_HAS_ROUGHNESS is not defined"
#endif
#ifndef RT_HAS_TRANSMISSION
#error "RT_HAS_TRANSMISSION is not defined"
#endif
#ifndef RT_HAS_ATTENUATION
#error "RT_HAS_ATTENUATION is not defined"
#endif
#ifndef RT_HAS_EMISSION
#error "RT_HAS_EMISSION is not defined"
#endif
#ifndef RT_LIGHT_COUNT
#error "RT_LIGHT_COUNT is not defined"
#endif
#ifndef RT_LIGHT_KINDS
#error "RT_LIGHT_KINDS is not defined"
#endif
#ifndef RT_HAS_ENVIRONMENT
#error "RT_HAS_ENVIRONMENT is not defined"
#endif
#ifndef RT_HAS_OCCLUSION
#error "RT_HAS_OCCLUSION is not defined"
#endif
#ifndef RT_VIEW
#error "RT_VIEW is not defined"
#endif
#ifndef RT_HAS_LENS
#error "RT_HAS_LENS is not defined"
#endif
#ifndef RT_MULTISAMPLE
#error "RT_MULTISAMPLE is not defined"
#endif
#ifndef RT_HAS_AOVS
#error "RT_HAS_AOVS is not defined"
#endif
#ifndef RT_HAS_TIME
#error "RT_HAS_TIME is not defined"
#endif
#ifndef RT_HAS_MOMENTS
#error "RT_HAS_MOMENTS is not defined"
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
const bool kMultipass = RT_MULTIPASS != 0; // the host then takes the pass_*.frag.glsl
const bool kCountWork = RT_COUNT_WORK != 0 || RT_HAS_AOVS != 0;
const bool kHasSlivers = RT_HAS_SLIVERS != 0;
const bool kHasTextures = RT_HAS_TEXTURES != 0;
const bool kHasNormalImages = RT_HAS_NORMAL_IMAGES != 0;
const bool kHasCutouts = RT_HAS_CUTOUTS != 0;
const bool kHasOpacity = RT_HAS_OPACITY != 0;
const bool kHasReflection = RT_HAS_REFLECTION != 0;
const bool kHasRoughness = RT_HAS_ROUGHNESS != 0;
const bool kHasTransmission = RT_HAS_TRANSMISSION != 0;
const bool kHasAttenuation = RT_HAS_ATTENUATION != 0;
const bool kHasEmission = RT_HAS_EMISSION != 0;
const uint kLightCount = uint(RT_LIGHT_COUNT);
const uint kLightKinds = uint(RT_LIGHT_KINDS);
const bool kHasEnvironment = RT_HAS_ENVIRONMENT != 0;
const bool kHasOcclusion = RT_HAS_OCCLUSION != 0;
const uint kView = uint(RT_VIEW);
const bool kHasLens = RT_HAS_LENS != 0;
const bool kMultisample = RT_MULTISAMPLE != 0;
const bool kHasAovs = RT_HAS_AOVS != 0;
const bool kHasTime = RT_HAS_TIME != 0; // reads the device's clock
const bool kHasMoments = RT_HAS_MOMENTS != 0;
const uint kMaxDepth = uint(RT_MAX_DEPTH);
const bool kHasLights = RT_LIGHT_COUNT != 0;

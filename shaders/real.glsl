// The type of all that is computed about rays and surfaces: float, or double where a reference is wanted. Colours stay float.
#if RT_DOUBLE
#define real double
#define real2 dvec2
#define real3 dvec3
#define real4 dvec4
const real kRoundoff = 1.1102230246251565e-16LF; // 2^-53
const real kSplitter = 134217729.0LF; // 2^27 + 1: halves the digits (Dekker 1971)
#else
#define real float
#define real2 vec2
#define real3 vec3
#define real4 vec4
const real kRoundoff = 5.9604645e-8f; // 2^-24
const real kSplitter = 4097.0f; // 2^12 + 1
#endif

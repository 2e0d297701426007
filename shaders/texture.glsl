// Images of the atlas: filtered between texels and between levels, in linear light.

// x is at most two periods below 0, as sampleLevel() gives it. In whole numbers: a float division may be off by one unit
// in the last place, and a whole period with it.
int wrapTexel(int x, int size, uint wrap) {
    if (wrap == kWrapClamp) return clamp(x, 0, size - 1);
    int period = wrap == kWrapMirror ? 2 * size : size;
    int inPeriod = (x + 2 * period) % period;
    return inPeriod < size ? inPeriod : period - 1 - inPeriod;
}

#if RT_HAS_TEXTURES // else the images and pages are not declared
vec4 fetchTexel(ImagePlace place, uvec4 rect, ivec2 texel) {
    ivec2 wrapped = ivec2(wrapTexel(texel.x, int(rect.z), place.page.y), wrapTexel(texel.y, int(rect.w), place.page.z));
    ivec3 at = ivec3(ivec2(rect.xy) + wrapped, int(place.page.x));
    if (place.page.w == kImageLinear) return texelFetch(linearPages, at, 0);
    return texelFetch(texturePages, at, 0);
}

// `uv` within two periods of the image.
vec4 sampleLevel(ImagePlace place, vec2 uv, uint level) {
    uvec4 rect = levelRect(place.rect, level);
    vec2 position = vec2(uv.x, 1.0f - uv.y) * vec2(rect.zw) - 0.5f;
    vec2 weight = fract(position);
    ivec2 texel = ivec2(floor(position));
    vec4 top = mix(fetchTexel(place, rect, texel), fetchTexel(place, rect, texel + ivec2(1, 0)), weight.x);
    vec4 bottom = mix(fetchTexel(place, rect, texel + ivec2(0, 1)), fetchTexel(place, rect, texel + ivec2(1, 1)), weight.x);
    return mix(top, bottom, weight.y);
}

// Over `footprint`, the square root of the part of texture space that the pixel covers. The pages' sRGB textures are decoded before
// texels are mixed.
vec4 sampleImage(uint image, vec2 texcoord, float footprint) {
    ImagePlace place = images[image];
    // Whole periods away from the image are taken off first: a float has no digits left for texels far out.
    vec2 period = vec2(place.page.y == kWrapMirror ? 2.0f : 1.0f, place.page.z == kWrapMirror ? 2.0f : 1.0f);
    vec2 near = texcoord - period * floor(texcoord / period);
    vec2 uv = vec2(place.page.y == kWrapClamp ? clamp(texcoord.x, 0.0f, 1.0f) : near.x,
                   place.page.z == kWrapClamp ? clamp(texcoord.y, 0.0f, 1.0f) : near.y);
    float texels = footprint * sqrt(float(place.rect.z) * float(place.rect.w));
    float finest = texels > 1.0f ? min(log2(texels), float(findMSB(max(place.rect.z, place.rect.w)))) : 0.0f;
    uint level = uint(finest);
    vec4 color = sampleLevel(place, uv, level);
    float toNext = finest - float(level);
    return toNext > 0.0f ? mix(color, sampleLevel(place, uv, level + 1u), toNext) : color;
}

vec2 texcoordAt(uvec4 vertices, vec3 weights) {
    return weights.x * loadTexcoord(vertices.x) + weights.y * loadTexcoord(vertices.y) + weights.z * loadTexcoord(vertices.z);
}
#else
vec4 sampleImage(uint image, vec2 texcoord, float footprint) {
    return vec4(1.0f);
}
vec2 texcoordAt(uvec4 vertices, vec3 weights) {
    return vec2(0.0f);
}
#endif

vec4 imageOr(uint image, vec2 texcoord, float footprint, vec4 otherwise) {
    return kHasTextures && image != kNoImage ? sampleImage(image, texcoord, footprint) : otherwise;
}

#define RT_KNOWS_CUTOUTS
// Whether a triangle is not there where it was hit.
bool isCutOut(Hit hit) {
    if (!kHasCutouts) return false;
    uvec4 vertices = loadTriangleVertices(hit.triangle);
    Material material = materials[vertices.w];
    if (material.transmission.w == 0.0f || (material.more.y & kMaterialClear) == 0u) return false;
    vec2 texcoord = texcoordAt(vertices, vec3(1.0f - hit.u - hit.v, hit.u, hit.v));
    return material.baseColor.a * imageOr(material.images.x, texcoord, 0.0f, vec4(1.0f)).a < material.transmission.w;
}

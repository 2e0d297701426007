// Light at a hit, and the rays that go on from it (Whitted 1980).
const float kLeastWeight = 1e-3f;    // rays whose light counts less than this in the pixel are not traced
const float kRouletteWeight = 0.05f; // of several samples, those that count less than this are traced now and then, and count more

uint innermost(uvec2 media) {
    return media.x & 0xFFFFu;
}

uvec2 afterEntering(uvec2 media, uint material) {
    return uvec2((media.x << 16) | (material & 0xFFFFu), (media.y << 16) | (media.x >> 16));
}

uvec2 afterLeaving(uvec2 media, uint material) {
    uvec4 list = uvec4(media.x & 0xFFFFu, media.x >> 16, media.y & 0xFFFFu, media.y >> 16);
    uint id = material & 0xFFFFu;
    if (list.x == id) list = uvec4(list.yzw, 0xFFFFu);
    else if (list.y == id) list = uvec4(list.x, list.zw, 0xFFFFu);
    else if (list.z == id) list = uvec4(list.xy, list.w, 0xFFFFu);
    else if (list.w == id) list.w = 0xFFFFu;
    return uvec2(list.x | (list.y << 16), list.z | (list.w << 16));
}

float indexOf(uint medium) {
    return medium == 0xFFFFu ? 1.0f : materials[medium].transmission.y;
}

uvec2 mediaBehind(Surface s, uvec2 media) {
    if (!kHasTransmission || s.thin) return media;
    return s.entering ? afterEntering(media, s.material) : afterLeaving(media, s.material);
}

// Index of refraction on the ray's side of the surface / on the other side.
float indexRatio(Surface s, uvec2 media) {
    if (!kHasTransmission && !kHasReflection) return 1.0f;
    float own = materials[s.material].transmission.y;
    if (!kHasTransmission || s.thin || s.transmission == 0.0f) return 1.0f / own;
    // A ray that has entered nothing and leaves a solid has begun in it.
    bool began = !s.entering && innermost(media) == 0xFFFFu;
    return (began ? own : indexOf(innermost(media))) / indexOf(innermost(mediaBehind(s, media)));
}

// Of white light after a way through the media, in atlas units (Beer 1852).
vec3 passedBy(uvec2 media, float way) {
    uint medium = innermost(media);
    if (!kHasAttenuation || medium == 0xFFFFu) return vec3(1.0f);
    Material m = materials[medium];
    if (m.transmission.z == 0.0f) return vec3(1.0f);
    return pow(max(m.attenuation.rgb, vec3(1e-6f)), vec3(way / (m.transmission.z * grid.worldOffset.w)));
}

float largest(vec3 v) {
    return max(v.x, max(v.y, v.z));
}

// Of light that goes through a surface.
struct Passed {
    vec3 all;
    vec3 straight; // without what glass bends: rays that are reflected to the light find only this on the same way
};

// How much light goes straight through a surface that shadows fall from. The angle is the one on the side of the lower index:
// so panes let through what they do, where light that really went straight would be reflected totally inside.
Passed shadowTint(Surface s, real3 direction, uvec2 media) {
    float cosine = float(abs(dot(s.normal, normalize(direction))));
    float eta = indexRatio(s, media);
    vec3 glass = kHasTransmission && s.transmission > 0.0f
                     ? enteringPart(s, cosine, min(eta, 1.0f / eta)) * s.transmission * s.baseColor
                     : vec3(0.0f);
    vec3 gap = vec3(1.0f - s.opacity);
    return Passed(gap + s.opacity * glass, s.thin ? gap + s.opacity * glass : gap);
}

// A hit as lights and new rays see it.
struct Scatter {
    vec3 diffuse; // albedo of the diffuse part
    vec3 view;    // unit, to where the ray came from
    vec3 normal;
    float cosView;
    float eta;
    bool rough;
    float alpha;
};

Scatter scatterAt(Surface s, real3 direction, uvec2 media) {
    Scatter c;
    c.view = -vec3(normalize(direction));
    c.normal = vec3(s.normal);
    c.cosView = max(dot(c.normal, c.view), 1e-4f);
    c.eta = indexRatio(s, media);
    c.rough = isRough(s);
    c.alpha = facetAlpha(s);
    c.diffuse = s.baseColor * (enteringPart(s, c.cosView, c.eta) * (1.0f - s.transmission));
    return c;
}

// Of light of radiance 1 from one direction.
struct Reflected {
    vec3 diffuse;
    vec3 glossy; // the part of it that reflected rays do not find
};

// From `toLight`, unit length; it is chosen with `density`, and by reflected rays too.
Reflected reflectedLight(Surface s, Scatter c, vec3 toLight, float density) {
    float cosLight = dot(c.normal, toLight);
    if (!(cosLight > 0.0f) || !(dot(vec3(s.geometricNormal), toLight) > 0.0f)) return Reflected(vec3(0.0f), vec3(0.0f));
    vec3 diffuse = c.diffuse * (cosLight / kPi);
    if (!c.rough) return Reflected(diffuse, vec3(0.0f));
    vec3 facet = normalize(c.view + toLight);
    vec3 aside = cross(c.normal, facet);
    float sineSquared = dot(aside, aside);
    float shadowing = 1.0f / (1.0f + smithLambda(c.alpha, c.cosView) + smithLambda(c.alpha, cosLight));
    float lobe = facetDensity(c.alpha, sineSquared) * shadowing / (4.0f * c.cosView);
    float share = density > 0.0f ? density / (density + reflectionDensity(c.alpha, c.cosView, sineSquared)) : 1.0f;
    return Reflected(diffuse, (1.0f - s.mirror) * reflectedPart(s, dot(c.view, facet), c.eta) * (lobe * share));
}

// From the environment: half of the directions by where it is bright, half by how a diffuse surface sees it (Veach & Guibas 1995).
Incident fromEnvironment(Scatter c, Sampler random, uint depth) {
    vec2 u = pairOf(random, kPairEnvironment, depth);
    float density;
    vec3 direction;
    bool byBrightness = u.x < 0.5f; // both halves of the pairs are spread evenly
    u.x = 2.0f * u.x - (byBrightness ? 0.0f : 1.0f);
    if (byBrightness) {
        direction = environmentDirection(u, density);
    } else {
        direction = frameAbout(c.normal) * onCosineHemisphere(u);
        density = environmentDensity(direction);
    }
    float both = 0.5f * (density + max(dot(c.normal, direction), 0.0f) / kPi);
    if (!(both > 0.0f)) return kDark;
    // Reflected rays know the first density only.
    return Incident(real3(direction), true, environmentRadiance(direction) / both, max(density, 1e-20f));
}

// Whether a ray of that weight is traced; it may then count for others that are not.
bool isTraced(inout vec3 weight, float u) {
    float most = largest(weight);
    if (!kMultisample || most >= kRouletteWeight) return most >= kLeastWeight;
    if (!(u * kRouletteWeight < most)) return false;
    weight *= kRouletteWeight / most;
    return true;
}

// The mirrored ray must stay on the surface's side even where the normal leans over.
real3 mirrored(real3 direction, Surface s, real3 normal) {
    real3 r = reflect(direction, normal);
    return dot(r, s.geometricNormal) > 0.0f ? r : reflect(direction, s.geometricNormal);
}

// There is room on the stack: stackSize() in tools/rt-trace/slot_layout.cpp counts what pushChildren() may push.
void push(Pending from, Surface s, real3 direction, vec3 weight, float density, float gone, uvec2 media) {
    storePending(pendingCount++, Pending(leaveSurface(s, direction), direction, weight, from.width, density, gone, from.depth + 1u, s.triangle, media));
}

// What a ray meets: the surface itself, or one of its facets.
struct Facet {
    real3 normal;
    float kept;    // of what it reflects, the part that other facets do not hide; of what it lets through, all goes on
    float density; // with which its reflection is chosen, per solid angle; 0: it is the only one
};

Facet facetFor(Surface s, Scatter c, Sampler random, uint depth) {
    if (!c.rough) return Facet(s.normal, 1.0f, 0.0f);
    mat3 frame = frameAbout(c.normal);
    vec3 view = transpose(frame) * c.view;
    vec3 facet = visibleFacet(c.alpha, vec3(view.xy, max(view.z, 1e-4f)), pairOf(random, kPairFacet, depth));
    float cosLight = reflect(-view, facet).z;
    float viewLambda = smithLambda(c.alpha, c.cosView);
    float kept = cosLight > 0.0f ? (1.0f + viewLambda) / (1.0f + viewLambda + smithLambda(c.alpha, cosLight)) : 0.0f;
    return Facet(real3(frame * facet), kept, reflectionDensity(c.alpha, c.cosView, dot(facet.xy, facet.xy)));
}

// The ray that goes on through the surface, of which `weight` enters; false, and no ray, if all is reflected.
bool pushThrough(Pending from, Surface s, real3 normal, float eta, vec3 weight, float u) {
    real3 bent = s.thin ? from.direction : refract(from.direction, normal, real(eta));
    if (dot(bent, bent) == 0.0f) return false;
    weight *= s.baseColor;
    // The normal may bend a grazing ray back to its own side; it then goes straight on.
    real3 through = dot(bent, s.geometricNormal) < 0.0f ? bent : from.direction;
    float chosen = s.thin ? from.density : 0.0f; // shadow rays do not bend
    if (isTraced(weight, u)) push(from, s, through, weight, chosen, from.gone, mediaBehind(s, from.media));
    return true;
}

// `from` is the ray as it came to the surface: its weight, its width and its way are those there.
void pushChildren(Pending from, Surface s, Scatter c, Sampler random) {
    if (from.depth >= kMaxDepth) return;
    vec2 chance = kMultisample ? pairOf(random, kPairRoulette, from.depth) : vec2(0.0f);
    vec3 rest = from.weight * s.opacity;
    if (kHasOpacity && s.opacity < 1.0f) {
        vec3 weight = from.weight - rest;
        if (isTraced(weight, chance.x)) push(from, s, from.direction, weight, from.density, from.gone, from.media);
    }
    if (s.unlit) return;
    Facet facet = facetFor(s, c, random, from.depth);
    float cosine = max(float(-dot(from.direction, facet.normal)), 1e-4f);
    vec3 mirrorWeight = rest * s.mirror;
    vec3 facetWeight = rest * (1.0f - s.mirror) * reflectedPart(s, cosine, c.eta) * facet.kept;
    if (kHasTransmission && s.transmission > 0.0f) {
        vec3 weight = rest * (enteringPart(s, cosine, c.eta) * s.transmission);
        if (!pushThrough(from, s, facet.normal, c.eta, weight, chance.y)) facetWeight += weight;
    }
    if (!kHasReflection && !kHasTransmission) return;
    if (!c.rough) {
        mirrorWeight += facetWeight;
    } else if (isTraced(facetWeight, chance.x)) {
        push(from, s, mirrored(from.direction, s, facet.normal), facetWeight, facet.density, 0.0f, from.media);
    }
    if (isTraced(mirrorWeight, chance.x)) push(from, s, mirrored(from.direction, s, s.normal), mirrorWeight, 0.0f, 0.0f, from.media);
}

const uint kMostTints = 64u;

void fly(Pending ray) {
    path = ray;
    flight = Flight(Ray(ray.origin, ray.direction, 0.0f, kUnlimited), false, false, ray.from);
}

// A hit's jobs, a shadow ray each: ambient light if it may be occluded, the lights, the environment.
uint lightJobs() {
    return kLightCount <= 1u ? kLightCount : grid.counts.w;
}
uint jobCount() {
    return uint(kHasOcclusion) + lightJobs() + uint(kHasEnvironment);
}

void flyToLight(Surface s, Ray ray, vec3 light, vec3 straight) {
    flight = Flight(ray, true, !kTints, s.triangle);
    arriving = Arriving(light, straight, 1.0f, 0u, path.media);
}

// Whether there is light to ask for, with a ray that then is the next.
bool askFor(Surface s, Scatter c, vec3 weight, Incident incident) {
    vec3 toLight = vec3(normalize(incident.endless ? incident.target : incident.target - s.position));
    Reflected reflected = reflectedLight(s, c, toLight, incident.density);
    vec3 light = weight * incident.radiance;
    if (!(largest(light * (reflected.diffuse + reflected.glossy)) > 0.0f)) return false;
    real3 origin = leaveSurface(s, real3(toLight));
    Ray ray = incident.endless ? Ray(origin, incident.target, 0.0f, kUnlimited) : Ray(origin, incident.target - origin, 0.0f, kBeforeLight);
    bool straight = kTints && incident.density > 0.0f;
    flyToLight(s, ray, light * (straight ? reflected.diffuse : reflected.diffuse + reflected.glossy),
               straight ? light * reflected.glossy : vec3(0.0f));
    return true;
}

bool askForAmbient(Surface s, Scatter c, vec3 weight, Sampler random) {
    vec3 light = weight * c.diffuse * picture.ambient.rgb;
    if (!(largest(light) > 0.0f)) return false;
    real3 direction = real3(frameAbout(c.normal) * onCosineHemisphere(pairOf(random, kPairOcclusion, path.depth)));
    if (dot(direction, s.geometricNormal) <= 0.0f) return false;
    flyToLight(s, Ray(leaveSurface(s, direction), direction, 0.0f, real(picture.ambient.w)), light, vec3(0.0f));
    flight.anyHit = true;
    return true;
}

bool askForLight(uint i, Surface s, Scatter c, vec3 weight, Sampler random) {
    vec2 u = kHasEmitters ? pairOf(random, kPairLights + i, path.depth) : vec2(0.5f);
    return askFor(s, c, weight, incidentFrom(lights[i], s.position, u));
}

// The next of the hit's jobs for which a ray is needed; false if none is left.
bool nextShadow(Surface s, Scatter c, Sampler random) {
    vec3 weight = path.weight * s.opacity;
    if (kHasOcclusion && job == 0u) {
        ++job;
        if (askForAmbient(s, c, weight, random)) return true;
    }
    uint firstLight = uint(kHasOcclusion), behindLights = firstLight + lightJobs();
    if (kHasLights)
        while (job < behindLights)
            if (askForLight(job++ - firstLight, s, c, weight, random)) return true;
    if (kHasEnvironment && job == behindLights) {
        ++job;
        return askFor(s, c, weight, fromEnvironment(c, random, path.depth));
    }
    return false;
}

// Whether light that has met a surface goes on behind it, with the next flight.
bool goesOn(Hit hit) {
    if (!kTints || flight.anyHit || ++arriving.surfaces >= kMostTints) return false;
    Ray ray = flight.ray;
    Surface s = surfaceAt(ray, hit, 0.0f);
    vec3 kept = passedBy(arriving.media, float(hit.t) * float(length(ray.direction)));
    Passed tint = shadowTint(s, ray.direction, arriving.media);
    arriving.light *= kept * tint.all;
    arriving.straight *= kept * tint.straight;
    arriving.left *= largest(kept * tint.all);
    if (arriving.left < kLeastWeight) return false;
    if (s.transmission > 0.0f) arriving.media = mediaBehind(s, arriving.media);
    real3 target = ray.origin + ray.direction; // where tMax is 1
    flight.ray.origin = leaveSurface(s, ray.direction);
    flight.from = kNoTriangle;
    if (ray.tMax <= 1.0f) flight.ray.direction = target - flight.ray.origin; // the rest of the way to the light
    return true;
}

// Of the shadow ray that met nothing.
vec3 arrivedLight() {
    vec3 light = arriving.light + arriving.straight;
    bool endless = flight.ray.tMax > 1e20f;
    return endless || flight.anyHit ? light : light * passedBy(arriving.media, float(flight.ray.tMax) * float(length(flight.ray.direction)));
}

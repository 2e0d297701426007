// What follows from a hit: the light that a sample gets, its next ray, and in the end the sums in the film's images.

// Radiance at the end of a ray that meets no triangle.
vec3 skyRadiance(Pending ray) {
    if (!kHasEnvironment) return picture.background.rgb;
    vec3 direction = vec3(ray.direction);
    float share = ray.density > 0.0f ? ray.density / (ray.density + environmentDensity(direction)) : 1.0f;
    return environmentRadiance(direction) * share;
}

ivec2 texelOf(uvec2 pixel) {
    return ivec2(pixel - picture.size.zw);
}

// What a pixel's first sample sees.
void storeFirstHit(uvec2 pixel, vec4 normalAndDepth, uint id, vec3 position, vec2 texcoord) {
    imageStore(surfaceImage, texelOf(pixel), normalAndDepth);
    imageStore(idImage, texelOf(pixel), uvec4(id));
#if RT_HAS_AOVS
    imageStore(positionImage, texelOf(pixel), vec4(position, 0.0f));
    imageStore(texcoordImage, texelOf(pixel), vec4(texcoord, 0.0f, 0.0f));
#endif
}

void recordPrimary(uvec2 pixel, uint index, Ray ray, Hit hit, Surface s) {
    sampleColor.a = 1.0f;
    sampleAlbedo = s.baseColor;
    if (index > 0u) return;
    real depthWorld = hit.t * (kView == kPanoramaView ? real(1.0f) : dot(ray.direction, real3(camera.forward.xyz))) / grid.worldOffset.w;
    vec3 position = vec3(s.position / grid.worldOffset.w + real3(grid.worldOffset.xyz));
    vec2 texcoord = texcoordAt(loadTriangleVertices(hit.triangle), vec3(1.0f - hit.u - hit.v, hit.u, hit.v));
    storeFirstHit(pixel, vec4(vec3(s.normal), float(depthWorld)), hit.triangle, position, texcoord);
}

// Adds what a ray of a path brings along without a surface; false if it has met one, which is then lit.
bool endsInLight(Hit hit) {
    bool missed = hit.triangle == kNoTriangle;
    if (kHasEmitters) {
        // A light in the plane of a surface is in front of it.
        Emitter emitter = emitterOnWay(flight.ray, hit.t * (1.0f + 1e-5f), path.gone);
        if (emitter.radiance != vec3(0.0f)) {
            float share = path.density > 0.0f ? path.density / (path.density + emitter.density) : 1.0f;
            sampleColor.rgb += path.weight * passedBy(path.media, float(emitter.t)) * emitter.radiance * share;
            if (path.depth == 0u) sampleColor.a = 1.0f;
            return true;
        }
    }
    if (missed) sampleColor.rgb += path.weight * skyRadiance(path);
    return missed;
}

// Light of the surface itself and around it; rays that go on from it wait.
void beginHit(Surface s, Scatter c, Sampler random) {
    vec3 light = s.unlit ? s.baseColor : s.emission;
    if (!kHasOcclusion && !s.unlit) light += c.diffuse * picture.ambient.rgb;
    sampleColor.rgb += path.weight * s.opacity * light;
    pushChildren(path, s, c, random);
    bool scatters = largest(c.diffuse) > 0.0f || c.rough;
    job = s.unlit || !scatters ? jobCount() : 0u;
}

// Whether the flight was one of a path and has met a surface, or one to a light behind which there may be others to ask.
void land(Hit hit, inout bool fresh, inout bool flying) {
    bool missed = hit.triangle == kNoTriangle;
    if (flight.shadow) {
        if (missed) sampleColor.rgb += arrivedLight();
        else flying = goesOn(hit);
    } else if (endsInLight(hit)) {
        job = jobCount();
    } else {
        lit = hit;
        job = 0u;
        fresh = true;
        path.width += float(hit.t) * pixelSpread();
        path.gone += float(hit.t);
    }
}

// Takes a hit and finds the sample's next ray; false if it has none.
bool follow(Hit hit, uvec2 pixel, uint index, Sampler random) {
    bool fresh = false, flying = false;
    land(hit, fresh, flying);
    if (!flying && (fresh || (kManyJobs && job < jobCount()))) {
        Ray ray = Ray(path.origin, path.direction, 0.0f, kUnlimited);
        Surface s = surfaceAt(ray, lit, path.width);
        if (fresh) path.weight *= passedBy(path.media, float(lit.t));
        Scatter c = scatterAt(s, path.direction, path.media);
        if (fresh) {
            if (path.depth == 0u) recordPrimary(pixel, index, ray, lit, s);
            beginHit(s, c, random);
        }
        if (job < jobCount()) flying = nextShadow(s, c, random);
    }
    if (!flying && pendingCount > 0u) {
        fly(loadPending(--pendingCount));
        flying = true;
    }
    return flying;
}

void beginSample(Place place) {
    path = Pending(flight.ray.origin, flight.ray.direction, vec3(1.0f), pixelWidth(), 0.0f, 0.0f, 0u, kNoTriangle, kNoMedia);
    pendingCount = 0u;
    job = 0u;
    sampleColor = vec4(0.0f);
    sampleAlbedo = vec3(0.0f);
    if (place.index == 0u) storeFirstHit(place.pixel, vec4(0.0f), kNoTriangle, vec3(0.0f), vec2(0.0f));
}

const float kCutShort = -1.0f; // as a sample's A

// Adds a pixel's samples to what it has.
void resolve(uvec2 pixel) {
    ivec2 texel = texelOf(pixel);
    bool resumed = picture.samples.x > 0u, cut = false;
    vec4 color = resumed ? imageLoad(colorImage, texel) : vec4(0.0f);
    vec2 moments = vec2(0.0f);
    vec4 albedo = vec4(0.0f); // A: clock ticks
    uvec4 counted = uvec4(0u);
#if RT_HAS_MOMENTS
    if (resumed) moments = imageLoad(momentImage, texel).xy;
#endif
#if RT_HAS_AOVS
    if (resumed) albedo = imageLoad(albedoImage, texel);
#endif
    for (uint i = 0u; i < picture.samples.y; ++i, sampleNumber += pixelSlots()) {
        loadSample();
        cut = cut || sampleColor.a == kCutShort;
        color += sampleColor;
        float luminance = dot(sampleColor.rgb, vec3(0.2126f, 0.7152f, 0.0722f));
        moments += vec2(luminance * luminance, luminance);
        if (kHasAovs) albedo.rgb += sampleAlbedo;
        if (kHasTime) albedo.a += uintBitsToFloat(loadWords(kPlaneTime).x);
        if (kCountWork) counted += loadWords(kPlaneWork);
    }
    imageStore(colorImage, texel, color);
#if RT_HAS_MOMENTS
    imageStore(momentImage, texel, vec4(moments, 0.0f, 0.0f));
#endif
#if RT_HAS_AOVS
    imageStore(albedoImage, texel, albedo);
    imageStore(texcoordImage, texel, imageLoad(texcoordImage, texel) + vec4(0.0f, 0.0f, vec2(counted.yz)));
#endif
#if RT_COUNT_WORK
    imageStore(counterImage, texel, counted + (resumed ? imageLoad(counterImage, texel) : uvec4(0u)));
#endif
    if (kSoftware && cut) imageStore(idImage, texel, uvec4(kWalkCutShort));
}

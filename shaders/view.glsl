// From a pixel and a sample to the ray that the camera sends.

// One axis of a point in [-1, 1], as likely as the Blackman-Harris window (Harris 1978) is high there; by halving, as its integral has
// no inverse.
float blackmanHarris(float u) {
    float lo = 0.0f, hi = 1.0f;
    for (int i = 0; i < 20; ++i) {
        float t = 0.5f * (lo + hi);
        float below = t + (-0.48829f * sin(2.0f * kPi * t) / (2.0f * kPi) + 0.14128f * sin(4.0f * kPi * t) / (4.0f * kPi) -
                           0.01168f * sin(6.0f * kPi * t) / (6.0f * kPi)) /
                              0.35875f;
        if (below < u) lo = t;
        else hi = t;
    }
    return lo + hi - 1.0f;
}

float tent(float u) {
    return u < 0.5f ? sqrt(2.0f * u) - 1.0f : 1.0f - sqrt(2.0f - 2.0f * u);
}

// Where in the pixel the sample lies, from its middle: chosen as often as the filter weighs it, so that all samples count the same
// (Ernst, Stamminger & Greiner 2006).
vec2 filterOffset(vec2 u) {
    float radius = picture.filterSize.x;
    uint kind = picture.samples.w;
    if (kind == kFilterTent) return radius * vec2(tent(u.x), tent(u.y));
    if (kind == kFilterBlackmanHarris) return radius * vec2(blackmanHarris(u.x), blackmanHarris(u.y));
    if (kind == kFilterGaussian) {
        const float kCut = 0.98889100f; // 1 - exp(-9 / 2): three sigmas are kept
        float distance = sqrt(-2.0f * log(1.0f - u.x * kCut)) / 3.0f;
        return radius * distance * vec2(cos(2.0f * kPi * u.y), sin(2.0f * kPi * u.y));
    }
    return radius * (2.0f * u - 1.0f);
}

// Rays of neighbouring pixels part by this much for each unit of their length: what textures are filtered over.
float pixelSpread() {
    return kView == kPerspectiveView ? 2.0f * length(camera.up.xyz) / float(picture.size.y)
                                     : kView == kPanoramaView ? kPi / float(picture.size.y) : 0.0f;
}

float pixelWidth() { // at the ray's origin
    return kView == kOrthographicView ? 2.0f * length(camera.up.xyz) / float(picture.size.y) : 0.0f;
}

real3 panoramaDirection(real2 at) {
    float longitude = kPi * float(at.x), latitude = 0.5f * kPi * float(at.y);
    real3 right = normalize(real3(camera.right.xyz)), up = normalize(real3(camera.up.xyz));
    real3 level = real(cos(longitude)) * real3(camera.forward.xyz) + real(sin(longitude)) * right;
    precise real3 direction = normalize(real(cos(latitude)) * level + real(sin(latitude)) * up);
    return direction;
}

const real kUnlimited = 1e30f;

Ray pixelRay(uvec2 pixel, Sampler s) {
    real2 place = real2(pixel) + 0.5f;
    if (kMultisample) place += real2(filterOffset(pairOf(s, kPairFilter, 0u)));
    real2 at = 2.0f * place / real2(picture.size.xy) - 1.0f;
    at.y = -at.y;
    real3 eye = real3(camera.eye.xyz);
    real3 across = camera.right.xyz * at.x + camera.up.xyz * at.y;
    precise real3 onPlane = eye + across; // here and below: every program goes on with the same ray
    if (kView == kOrthographicView) return Ray(onPlane, real3(camera.forward.xyz), 0.0f, kUnlimited);
    if (kView == kPanoramaView) return Ray(eye, panoramaDirection(at), 0.0f, kUnlimited);
    real3 direction = camera.forward.xyz + across;
    if (kHasLens) {
        vec2 onLens = camera.eye.w * onDisc(pairOf(s, kPairLens, 0u));
        real3 shift = real3(normalize(camera.right.xyz) * onLens.x + normalize(camera.up.xyz) * onLens.y);
        direction = direction * real(camera.forward.w) - shift;
        eye += shift;
    }
    precise real3 unit = normalize(direction);
    return Ray(eye, unit, 0.0f, kUnlimited);
}

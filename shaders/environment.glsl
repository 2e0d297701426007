// Light from all around: a latitude-longitude picture whose top row is straight up (+y) and whose middle column is -z.

#if RT_HAS_ENVIRONMENT // else the picture and the table are not declared
vec2 environmentPlace(vec3 direction) {
    float u = atan(direction.x, -direction.z) / (2.0f * kPi) + 0.5f + picture.environment.w;
    return vec2(u - floor(u), acos(clamp(direction.y, -1.0f, 1.0f)) / kPi);
}

vec3 environmentRadiance(vec3 direction) {
    return picture.environment.rgb * textureLod(environmentMap, environmentPlace(direction), 0.0f).rgb;
}

uint environmentWidth() {
    return uint(environmentTable[0]);
}
uint environmentHeight() {
    return uint(environmentTable[1]);
}

// Which of `count` steps of a table at `first` holds u; where in it, and how likely it is.
uint stepOf(uint first, uint count, float u, out float inStep, out float share) {
    uint lo = 0u, hi = count;
    while (hi - lo > 1u) {
        uint middle = (lo + hi) / 2u;
        if (environmentTable[first + middle] <= u) lo = middle;
        else hi = middle;
    }
    float below = environmentTable[first + lo];
    share = environmentTable[first + lo + 1u] - below;
    inStep = share > 0.0f ? clamp((u - below) / share, 0.0f, 0.99999f) : 0.5f;
    return lo;
}

// Per solid angle, of a place whose row and texel are as likely as that.
float environmentDensity(float rowShare, float texelShare, float v) {
    float sine = sin(kPi * v);
    return sine > 0.0f ? rowShare * texelShare * float(environmentWidth() * environmentHeight()) / (2.0f * kPi * kPi * sine) : 0.0f;
}

float environmentDensity(vec3 direction) {
    vec2 place = environmentPlace(direction);
    uint width = environmentWidth(), height = environmentHeight();
    uint row = min(uint(place.y * float(height)), height - 1u), texel = min(uint(place.x * float(width)), width - 1u);
    uint inRow = environmentRow(width, height, row) + texel, above = kEnvironmentRows + row;
    return environmentDensity(environmentTable[above + 1u] - environmentTable[above],
                              environmentTable[inRow + 1u] - environmentTable[inRow], place.y);
}

vec3 environmentDirection(vec2 u, out float density) {
    uint width = environmentWidth(), height = environmentHeight();
    float inRow, inTexel, rowShare, texelShare;
    uint row = stepOf(kEnvironmentRows, height, u.y, inRow, rowShare);
    uint texel = stepOf(environmentRow(width, height, row), width, u.x, inTexel, texelShare);
    vec2 place = vec2((float(texel) + inTexel) / float(width), (float(row) + inRow) / float(height));
    density = environmentDensity(rowShare, texelShare, place.y);
    float longitude = 2.0f * kPi * (place.x - picture.environment.w - 0.5f), polar = kPi * place.y;
    return vec3(sin(polar) * sin(longitude), cos(polar), -sin(polar) * cos(longitude));
}
#else
vec3 environmentRadiance(vec3 direction) {
    return vec3(0.0f);
}
float environmentDensity(vec3 direction) {
    return 0.0f;
}
vec3 environmentDirection(vec2 u, out float density) {
    density = 0.0f;
    return vec3(0.0f);
}
#endif

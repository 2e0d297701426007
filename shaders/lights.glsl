// Lights: a direction from which a surface is lit, and what rays see of lights that have a size.

bool isKind(Light light, uint kind) { // false at once for kinds that the scene has none of
    return (kLightKinds & (1u << kind)) != 0u && (kLightKinds == (1u << kind) || light.kind.x == kind);
}
const bool kHasEmitters = (kLightKinds & ((1u << kLightRectangle) | (1u << kLightSphere))) != 0u;

// Light that comes to a surface from one direction.
struct Incident {
    real3 target;   // where it comes from, or, if that is endless, the direction there
    bool endless;
    vec3 radiance;  // divided by `density` where there is one
    float density;  // of the direction, per solid angle; 0: there is no other
};

const Incident kDark = Incident(real3(0.0f), false, vec3(0.0f), 0.0f);

float spotCone(Light light, vec3 away) {
    float cosine = dot(light.direction.xyz, away), outer = light.direction.w, inner = light.edgeU.w;
    if (cosine <= outer) return 0.0f;
    float t = inner > outer ? clamp((cosine - outer) / (inner - outer), 0.0f, 1.0f) : 1.0f;
    return t * t;
}

float rectangleArea(Light light) {
    return 4.0f * length(light.edgeU.xyz) * length(light.edgeV.xyz);
}

Incident fromRectangle(Light light, real3 position, vec2 u) {
    vec2 at = 2.0f * u - 1.0f;
    real3 target = real3(light.position.xyz) + real3(light.edgeU.xyz * at.x + light.edgeV.xyz * at.y);
    vec3 way = vec3(target - position);
    float squared = dot(way, way);
    float facing = -dot(way, light.direction.xyz) * inversesqrt(squared);
    if (!(facing > 0.0f)) return kDark;
    float density = squared / (facing * rectangleArea(light));
    return Incident(target, false, light.intensity.rgb / density, density);
}

// 1 - cosine of the half angle under which a sphere is seen, from outside.
float sphereCap(float radius, float squaredDistance) {
    float sineSquared = radius * radius / squaredDistance;
    return sineSquared / (1.0f + sqrt(max(0.0f, 1.0f - sineSquared)));
}

Incident fromSphere(Light light, real3 position, vec2 u) {
    vec3 way = vec3(real3(light.position.xyz) - position);
    float squared = dot(way, way), radius = light.position.w;
    if (squared <= radius * radius) return kDark;
    float cap = sphereCap(radius, squared);
    float lift = u.x * cap; // 1 - cosine
    float sine = sqrt(max(0.0f, lift * (2.0f - lift)));
    vec3 direction = frameAbout(way * inversesqrt(squared)) * vec3(sine * cos(2.0f * kPi * u.y), sine * sin(2.0f * kPi * u.y), 1.0f - lift);
    float along = dot(way, direction);
    vec3 beside = way - along * direction;
    float distance = along - sqrt(max(0.0f, radius * radius - dot(beside, beside)));
    float density = 1.0f / (2.0f * kPi * cap);
    return Incident(position + real3(direction * distance), false, light.intensity.rgb / density, density);
}

Incident incidentFrom(Light light, real3 position, vec2 u) {
    if (isKind(light, kLightRectangle)) return fromRectangle(light, position, u);
    if (isKind(light, kLightSphere)) return fromSphere(light, position, u);
    if (isKind(light, kLightDirectional)) return Incident(real3(-light.direction.xyz), true, light.intensity.rgb, 0.0f);
    vec3 way = vec3(real3(light.position.xyz) - position);
    float squared = dot(way, way);
    float cone = isKind(light, kLightSpot) ? spotCone(light, -way * inversesqrt(squared)) : 1.0f;
    return Incident(real3(light.position.xyz), false, light.intensity.rgb * (cone / squared), 0.0f);
}

// A light with a size on a ray's way.
struct Emitter {
    real t; // the ray's tMax where there is none
    vec3 radiance;
    float density; // of the direction, for who chooses points on the light
};

Emitter rectangleOnWay(Ray ray, Light light, Emitter nearest) {
    real facing = dot(ray.direction, real3(light.direction.xyz));
    if (!(facing < 0.0f)) return nearest;
    real t = dot(real3(light.position.xyz) - ray.origin, real3(light.direction.xyz)) / facing;
    if (!(t > ray.tMin && t < nearest.t)) return nearest;
    vec3 at = vec3(ray.origin + t * ray.direction - real3(light.position.xyz));
    vec2 edges = vec2(dot(at, light.edgeU.xyz) / dot(light.edgeU.xyz, light.edgeU.xyz), dot(at, light.edgeV.xyz) / dot(light.edgeV.xyz, light.edgeV.xyz));
    if (max(abs(edges.x), abs(edges.y)) > 1.0f) return nearest;
    float speed = float(length(ray.direction));
    float distance = float(t) * speed;
    return Emitter(t, light.intensity.rgb, distance * distance * speed / (float(-facing) * rectangleArea(light)));
}

Emitter sphereOnWay(Ray ray, Light light, Emitter nearest) {
    real3 way = real3(light.position.xyz) - ray.origin;
    real squaredSpeed = dot(ray.direction, ray.direction), radius = real(light.position.w);
    real middle = dot(way, ray.direction) / squaredSpeed;
    real3 beside = way - middle * ray.direction;
    real inside = (radius * radius - dot(beside, beside)) / squaredSpeed;
    real squared = dot(way, way);
    if (!(inside > 0.0f) || squared <= radius * radius) return nearest;
    real t = middle - sqrt(inside);
    if (!(t > ray.tMin && t < nearest.t)) return nearest;
    return Emitter(t, light.intensity.rgb, 1.0f / (2.0f * kPi * sphereCap(light.position.w, float(squared))));
}

Emitter emitterOnWay(Ray ray, real tMax) {
    Emitter nearest = Emitter(tMax, vec3(0.0f), 0.0f);
    if (kHasEmitters)
        for (uint i = 0u; i < grid.counts.w; ++i) {
            if (isKind(lights[i], kLightRectangle)) nearest = rectangleOnWay(ray, lights[i], nearest);
            if (isKind(lights[i], kLightSphere)) nearest = sphereOnWay(ray, lights[i], nearest);
        }
    return nearest;
}

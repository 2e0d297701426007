#include "tests/reference/scene.h"

#include "tests/support/embree_scene.h"

#include <cmath>

namespace rt::reference {
namespace {

Vec mixed(const SharedSpan<glm::vec3>& values, const glm::uvec3& corners, const Vec& weights) {
    return weights.x * Vec(values[corners.x]) + weights.y * Vec(values[corners.y]) +
           weights.z * Vec(values[corners.z]);
}

// Source: IEC 61966-2-1 (sRGB).
double linearOf(std::uint32_t byte) {
    const double s = byte / 255.0;
    return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
}

std::int64_t wrapped(double floored, std::uint32_t size, std::uint32_t wrap) {
    const auto texel = static_cast<std::int64_t>(floored), n = std::int64_t(size);
    if (wrap == kWrapClamp) return std::min(std::max(texel, std::int64_t(0)), n - 1);
    const std::int64_t period = wrap == kWrapMirror ? 2 * n : n;
    const std::int64_t rest = ((texel % period) + period) % period;
    return rest < n ? rest : period - 1 - rest;
}

// Between the four nearest texels; an sRGB image with straight alpha.
glm::dvec4 sample(const Mesh& mesh, std::uint32_t index, const glm::dvec2& texcoord) {
    const MeshImage& image = mesh.images[index];
    const double x = texcoord.x * image.width - 0.5, y = (1.0 - texcoord.y) * image.height - 0.5;
    glm::dvec4 sum(0.0);
    for (const double right : {0.0, 1.0})
        for (const double below : {0.0, 1.0}) {
            const double column = std::floor(x) + right, row = std::floor(y) + below;
            const auto at = wrapped(row, image.height, image.wrapV) * image.width +
                            wrapped(column, image.width, image.wrapU);
            const std::uint32_t texel = mesh.pixels[image.firstPixel + static_cast<std::uint64_t>(at)];
            const double weight = (1.0 - std::abs(x - column)) * (1.0 - std::abs(y - row));
            for (int c = 0; c < 3; ++c) sum[c] += weight * linearOf((texel >> (8 * c)) & 255u);
            sum.w += weight * (texel >> 24) / 255.0;
        }
    return sum;
}

} // namespace

Scene::Scene(const Mesh& mesh)
    : mesh_(mesh), gap_(1e-6 * double(glm::length(boundsOf(mesh).extent()))), device_(rtcNewDevice(nullptr)),
      scene_(test::newEmbreeScene(device_, mesh)) {
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
    rtcCommitScene(scene_);
}

Scene::~Scene() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
}

std::optional<Surface> Scene::nearest(const Ray& ray) const {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    const glm::vec3 origin(ray.origin), direction(ray.direction);
    RTCRayHit query{};
    query.ray.org_x = origin.x;
    query.ray.org_y = origin.y;
    query.ray.org_z = origin.z;
    query.ray.dir_x = direction.x;
    query.ray.dir_y = direction.y;
    query.ray.dir_z = direction.z;
    query.ray.tfar = 1e30f;
    query.ray.mask = ~0u;
    query.hit.geomID = query.hit.primID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scene_, &context, &query);
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
    return surfaceAt(ray, query.hit.primID);
}

Surface Scene::surfaceAt(const Ray& ray, std::uint32_t triangle) const {
    const glm::uvec3 corners = mesh_.triangles[triangle];
    const Vec a(mesh_.positions[corners.x]), b(mesh_.positions[corners.y]), c(mesh_.positions[corners.z]);
    const Vec cross = glm::cross(b - a, c - a);
    const double facing = glm::dot(cross, ray.direction);
    Surface s;
    s.distance = glm::dot(cross, a - ray.origin) / facing;
    s.position = ray.origin + ray.direction * s.distance;
    const Vec off = s.position - a; // barycentric coordinates are parts of the area
    const double v = glm::dot(glm::cross(off, c - a), cross) / glm::dot(cross, cross);
    const double w = glm::dot(glm::cross(b - a, off), cross) / glm::dot(cross, cross);
    const Vec weights(1.0 - v - w, v, w);
    s.entering = facing <= 0.0;
    s.face = glm::normalize(cross) * (s.entering ? 1.0 : -1.0);
    s.normal = glm::normalize(mixed(mesh_.normals, corners, weights));
    if (glm::dot(s.normal, s.face) < 0.0) s.normal = -s.normal;
    s.material = mesh_.triangleMaterial[triangle];
    addMaterial(s, corners, weights);
    return s;
}

void Scene::addMaterial(Surface& s, const glm::uvec3& corners, const Vec& weights) const {
    const Material& m = mesh_.materials[s.material];
    glm::dvec4 color(m.baseColor);
    if (m.images.x != kNoImage) {
        const auto at = [&](std::uint32_t corner) { return glm::dvec2(mesh_.texcoords[corner]); };
        color *= sample(mesh_, m.images.x,
                        weights.x * at(corners.x) + weights.y * at(corners.y) + weights.z * at(corners.z));
    }
    s.color = Vec(color);
    s.emission = Vec(m.emission);
    s.opacity = (m.more.y & kMaterialClear) != 0 && m.transmission.w == 0.0f ? color.w : 1.0;
    s.metallic = m.reflection.x;
    s.roughness = m.reflection.y;
    s.specular = m.reflection.z;
    s.mirror = m.reflection.w;
    s.transmission = m.transmission.x;
    s.thin = (m.more.y & kMaterialThin) != 0;
    s.unlit = (m.more.y & kMaterialUnlit) != 0;
}

} // namespace rt::reference

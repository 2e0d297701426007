#include "tests/reference/renderer.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace rt::reference {
namespace {

constexpr double kEndless = 1e30;
constexpr double kLeastCosine = 1e-4;

using Media = std::vector<std::uint32_t>; // materials that a ray is in, the last entered last

Media behind(const Surface& s, Media media) {
    if (s.thin) return media;
    if (s.entering) {
        media.push_back(s.material);
        return media;
    }
    const auto left = std::find(media.rbegin(), media.rend(), s.material);
    if (left != media.rend()) media.erase(std::next(left).base());
    return media;
}

struct Lamp {
    double distance;
    Vec radiance;
};

class Renderer {
public:
    Renderer(const Mesh& mesh, const Settings& settings) : scene_(mesh), settings_(settings) {}

    Vec radiance(const Ray& ray, const Media& media, unsigned depth, Random& random) const {
        const auto hit = scene_.nearest(ray);
        // A lamp in the plane of a surface is in front of it.
        if (const auto lamp = lampOnWay(ray, hit ? hit->distance * (1.0 + 1e-5) : kEndless))
            return passed(media, lamp->distance) * lamp->radiance;
        if (!hit) return settings_.sky(ray.direction);
        return passed(media, hit->distance) * leaving(*hit, ray.direction, media, depth, random);
    }

private:
    double indexOf(const Media& media) const {
        return media.empty() ? 1.0 : double(scene_.material(media.back()).transmission.y);
    }

    struct Indices {
        double here, beyond;
    };
    Indices indicesAt(const Surface& s, const Media& media) const {
        const double own = scene_.material(s.material).transmission.y;
        if (s.thin || s.transmission == 0.0) return {1.0, own};
        return {media.empty() && !s.entering ? own : indexOf(media), indexOf(behind(s, media))};
    }

    // Beer's law.
    Vec passed(const Media& media, double way) const {
        if (media.empty()) return Vec(1.0);
        const Material& m = scene_.material(media.back());
        if (m.transmission.z == 0.0f) return Vec(1.0);
        Vec left;
        for (int c = 0; c < 3; ++c)
            left[c] = std::pow(std::max(double(m.attenuation[c]), 1e-6), way / double(m.transmission.z));
        return left;
    }

    double dielectricPart(const Surface& s, double cosine, const Indices& n) const {
        const double once = fresnel(cosine, n.here, n.beyond);
        return s.specular * (s.thin ? 2.0 * once / (1.0 + once) : once);
    }
    Vec reflectedPart(const Surface& s, double cosine, const Indices& n) const {
        return (1.0 - s.mirror) * (s.metallic * metalReflectance(cosine, s.color) +
                                   (1.0 - s.metallic) * dielectricPart(s, cosine, n));
    }
    double enteringPart(const Surface& s, double cosine, const Indices& n) const {
        return (1.0 - s.mirror) * (1.0 - s.metallic) * (1.0 - dielectricPart(s, cosine, n));
    }

    std::optional<Lamp> lampOnWay(const Ray& ray, double limit) const {
        std::optional<Lamp> nearest;
        for (const Light& light : settings_.lights) {
            const double t = distanceTo(light, ray);
            if (!(t > 0.0 && t < limit)) continue;
            limit = t;
            nearest = Lamp{t, Vec(light.intensity)};
        }
        return nearest;
    }

    static double distanceTo(const Light& light, const Ray& ray) {
        const Vec way = Vec(light.position) - ray.origin;
        if (light.kind.x == kLightRectangle) {
            const double facing = glm::dot(ray.direction, Vec(light.direction));
            if (facing >= 0.0) return -1.0;
            const double t = glm::dot(way, Vec(light.direction)) / facing;
            const Vec at = ray.direction * t - way, u(light.edgeU), v(light.edgeV);
            return std::abs(glm::dot(at, u)) <= glm::dot(u, u) && std::abs(glm::dot(at, v)) <= glm::dot(v, v)
                       ? t
                       : -1.0;
        }
        if (light.kind.x != kLightSphere) return -1.0;
        const double radius = light.position.w, along = glm::dot(way, ray.direction);
        const double inside = along * along - glm::dot(way, way) + radius * radius;
        return inside > 0.0 && glm::dot(way, way) > radius * radius ? along - std::sqrt(inside) : -1.0;
    }

    // Light that goes straight to a place, or endlessly far, tinted by what is clear.
    Vec unblocked(const Surface& from, const Vec& direction, double distance, Media media) const {
        Vec left(1.0);
        Ray ray{from.leave(direction, scene_.gap()), direction};
        double rest = distance * (1.0 - 1e-4);
        for (int i = 0; i < 64; ++i) {
            const auto hit = scene_.nearest(ray);
            if (!hit || hit->distance >= rest)
                return distance >= kEndless ? left : left * passed(media, rest);
            left *= passed(media, hit->distance) * straightThrough(*hit, direction, media);
            if (std::max({left.x, left.y, left.z}) < 1e-3) return Vec(0.0);
            if (hit->transmission > 0.0) media = behind(*hit, media);
            rest -= hit->distance;
            ray.origin = hit->leave(direction, scene_.gap());
        }
        return Vec(0.0);
    }

    Vec straightThrough(const Surface& s, const Vec& direction, const Media& media) const {
        Vec glass(0.0);
        if (s.transmission > 0.0) {
            Indices n = indicesAt(s, media);
            if (n.here > n.beyond) std::swap(n.here, n.beyond);
            glass = enteringPart(s, std::abs(glm::dot(s.normal, direction)), n) * s.transmission * s.color;
        }
        return (1.0 - s.opacity) + s.opacity * glass;
    }

    /// A surface that is being shaded.
    struct Shading {
        const Surface& s;
        const Media& media;
        Vec view; // to where the ray came from
        double cosView;
        Indices n;
        Vec diffuse; // albedo
        Facets facets;
        unsigned depth;

        Vec local(const Vec& v) const { // about the normal
            const Vec other = turnedTo(s.normal, Vec(1, 0, 0));
            return {glm::dot(v, other), glm::dot(v, glm::cross(s.normal, other)), glm::dot(v, s.normal)};
        }
        Vec localView() const {
            const Vec v = local(view);
            return {v.x, v.y, std::max(v.z, kLeastCosine)};
        }
        bool faces(const Vec& direction) const {
            return glm::dot(s.normal, direction) > 0.0 && glm::dot(s.face, direction) > 0.0;
        }
    };

    Vec leaving(const Surface& s, const Vec& direction, const Media& media, unsigned depth,
                Random& random) const {
        const bool deeper = depth < settings_.maxDepth;
        if (s.opacity < 1.0 && random.unit() >= s.opacity)
            return deeper ? radiance({s.leave(direction, scene_.gap()), direction}, media, depth + 1, random)
                          : Vec(0.0);
        if (s.unlit) return s.color;
        const Indices n = indicesAt(s, media);
        const double cosView = std::max(glm::dot(s.normal, -direction), kLeastCosine);
        const Shading shading{s,
                              media,
                              -direction,
                              cosView,
                              n,
                              s.color * (enteringPart(s, cosView, n) * (1.0 - s.transmission)),
                              Facets{s.roughness * s.roughness},
                              depth};
        Vec sum = s.emission;
        for (const Light& light : settings_.lights) sum += lightOf(light, shading, random);
        if (settings_.skyLights) sum += skyLight(shading, random);
        return deeper ? sum + scattered(shading, random) : sum;
    }

    Vec lightOf(const Light& light, const Shading& at, Random& random) const {
        if (light.kind.x == kLightRectangle || light.kind.x == kLightSphere)
            return lampLight(light, at, random);
        const bool endless = light.kind.x == kLightDirectional;
        const Vec way = endless ? -Vec(light.direction) : Vec(light.position) - at.s.position;
        const double distance = glm::length(way);
        const Vec toLight = way / distance;
        if (!at.faces(toLight)) return Vec(0.0);
        Vec reflected = at.diffuse * (glm::dot(at.s.normal, toLight) / kPi);
        if (at.s.rough())
            reflected += reflectedPart(at.s, glm::dot(at.view, glm::normalize(at.view + toLight)), at.n) *
                         at.facets.lobe(at.localView(), at.local(toLight));
        double strength = endless ? 1.0 : 1.0 / (distance * distance);
        if (light.kind.x == kLightSpot) strength *= spotPart(light, -toLight);
        return Vec(light.intensity) * strength * reflected *
               unblocked(at.s, toLight, endless ? kEndless : distance, at.media);
    }

    static double spotPart(const Light& light, const Vec& away) {
        const double cosine = glm::dot(Vec(light.direction), away), outer = light.direction.w,
                     inner = light.edgeU.w;
        const double part = std::clamp((cosine - outer) / (inner - outer), 0.0, 1.0);
        return part * part;
    }

    // On diffuse surfaces, from a point anywhere on the lamp.
    Vec lampLight(const Light& light, const Shading& at, Random& random) const {
        if (at.diffuse == Vec(0.0)) return Vec(0.0);
        Vec point, outward;
        double area;
        if (light.kind.x == kLightRectangle) {
            const Vec u(light.edgeU), v(light.edgeV);
            point = Vec(light.position) + u * (2.0 * random.unit() - 1.0) + v * (2.0 * random.unit() - 1.0);
            outward = Vec(light.direction);
            area = 4.0 * glm::length(u) * glm::length(v);
        } else {
            const double z = 2.0 * random.unit() - 1.0, around = 2.0 * kPi * random.unit();
            const double across = std::sqrt(1.0 - z * z), radius = light.position.w;
            outward = {across * std::cos(around), across * std::sin(around), z};
            point = Vec(light.position) + outward * radius;
            area = 4.0 * kPi * radius * radius;
        }
        const Vec way = point - at.s.position;
        const double distance = glm::length(way);
        const Vec toLight = way / distance;
        const double facing = -glm::dot(outward, toLight);
        if (facing <= 0.0 || !at.faces(toLight)) return Vec(0.0);
        return Vec(light.intensity) * at.diffuse * unblocked(at.s, toLight, distance, at.media) *
               (glm::dot(at.s.normal, toLight) / kPi * facing * area / (distance * distance));
    }

    // From any direction of the hemisphere.
    Vec skyLight(const Shading& at, Random& random) const {
        if (at.diffuse == Vec(0.0)) return Vec(0.0);
        const double z = random.unit(), across = std::sqrt(1.0 - z * z), around = 2.0 * kPi * random.unit();
        const Vec toLight = turnedTo(at.s.normal, {across * std::cos(around), across * std::sin(around), z});
        if (!at.faces(toLight)) return Vec(0.0);
        return settings_.sky(toLight) * at.diffuse * (2.0 * z) * unblocked(at.s, toLight, kEndless, at.media);
    }

    // What is mirrored must stay on the surface's side even where the normal leans over.
    Vec mirrored(const Shading& at, const Vec& normal) const {
        const Vec r = glm::reflect(-at.view, normal);
        return glm::dot(r, at.s.face) > 0.0 ? r : glm::reflect(-at.view, at.s.face);
    }

    Vec onward(const Shading& at, const Vec& direction, const Media& media, Random& random) const {
        return radiance({at.s.leave(direction, scene_.gap()), direction}, media, at.depth + 1, random);
    }

    // One of the rays that follow, and what it stands for.
    Vec scattered(const Shading& at, Random& random) const {
        const Surface& s = at.s;
        if (s.mirror > 0.0 && random.unit() < s.mirror)
            return onward(at, mirrored(at, s.normal), at.media, random);
        const double chosen = 1.0 / (1.0 - s.mirror); // the parts below are of all light
        Vec normal = s.normal;
        double kept = 1.0;
        if (s.rough()) {
            const Vec facet = at.facets.choose(at.localView(), random), view = at.localView();
            const Vec other = turnedTo(s.normal, Vec(1, 0, 0));
            normal = other * facet.x + glm::cross(s.normal, other) * facet.y + s.normal * facet.z;
            kept = at.facets.unhidden(view, 2.0 * glm::dot(view, facet) * facet - view);
        }
        const double cosine = std::max(glm::dot(at.view, normal), kLeastCosine);
        Vec reflected = reflectedPart(s, cosine, at.n) * kept;
        Vec through = enteringPart(s, cosine, at.n) * s.transmission * s.color;
        Vec bent = s.thin ? -at.view : refracted(-at.view, normal, at.n);
        if (bent == Vec(0.0)) { // total reflection takes all
            reflected += enteringPart(s, cosine, at.n) * s.transmission;
            through = Vec(0.0);
        }
        if (glm::dot(bent, s.face) >= 0.0) bent = -at.view;
        const double r = std::max({reflected.x, reflected.y, reflected.z});
        const double t = std::max({through.x, through.y, through.z});
        if (r + t <= 0.0) return Vec(0.0);
        const double likely = std::min(r + t, 1.0) / (r + t); // the rest of the rays end here
        const double u = random.unit();
        if (u < r * likely)
            return reflected * (chosen / (r * likely)) * onward(at, mirrored(at, normal), at.media, random);
        if (u < (r + t) * likely)
            return through * (chosen / (t * likely)) * onward(at, bent, behind(s, at.media), random);
        return Vec(0.0);
    }

    // Snell's law; 0 where there is total reflection.
    static Vec refracted(const Vec& direction, const Vec& normal, const Indices& n) {
        const Vec across = direction - normal * glm::dot(direction, normal); // of length sine
        const Vec beyond = across * (n.here / n.beyond);
        const double sine2 = glm::dot(beyond, beyond);
        return sine2 >= 1.0 ? Vec(0.0) : beyond - normal * std::sqrt(1.0 - sine2);
    }

    Scene scene_;
    const Settings& settings_;
};

Ray rayThrough(const Settings& settings, const CameraBasis& basis, double x, double y) {
    const double u = 2.0 * x / settings.size.x - 1.0, v = 1.0 - 2.0 * y / settings.size.y;
    return {settings.pose.eye, glm::normalize(basis.forward + basis.right * (basis.halfWidth * u) +
                                              basis.up * (basis.halfHeight * v))};
}

} // namespace

std::vector<Pixel> render(const Mesh& mesh, const Settings& settings) {
    const Renderer renderer(mesh, settings);
    const CameraBasis basis = basisOf(settings.pose, double(settings.size.x) / settings.size.y);
    std::vector<Pixel> pixels(std::size_t(settings.size.x) * settings.size.y);
    const auto renderPixel = [&](std::size_t i) {
        Random random(0x9E3779B97F4A7C15u * (i + 1));
        double squares = 0.0;
        for (unsigned k = 0; k < settings.samples; ++k) {
            const double x = double(i % settings.size.x) + random.unit(),
                         y = double(i / settings.size.x) + random.unit();
            const Vec color = renderer.radiance(rayThrough(settings, basis, x, y), {}, 0, random);
            const double luminance = glm::dot(color, Vec(0.2126, 0.7152, 0.0722));
            pixels[i].mean += color / double(settings.samples);
            pixels[i].luminance += luminance / settings.samples;
            squares += luminance * luminance / settings.samples;
        }
        const double variance = std::max(squares - pixels[i].luminance * pixels[i].luminance, 0.0);
        pixels[i].error = std::sqrt(variance / std::max(settings.samples - 1u, 1u));
    };
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, pixels.size(), 16), [&](const auto& range) {
        for (std::size_t i = range.begin(); i < range.end(); ++i) renderPixel(i);
    });
    return pixels;
}

} // namespace rt::reference

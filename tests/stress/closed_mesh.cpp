#include "tests/stress/closed_mesh.h"

#include "common/stage_timer.h"
#include "tests/support/make_mesh.h"
#include "tests/support/split_mix.h"
#include "tools/rt-import/import_model.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <tuple>
#include <utility>

namespace rt::test {
namespace {

using Edge = std::pair<std::uint32_t, std::uint32_t>;
using Triangles = std::vector<glm::uvec3>;
using Positions = std::vector<glm::vec3>;

constexpr std::size_t kInsides = 24;

std::array<Edge, 3> edgesOf(const glm::uvec3& t) {
    return {Edge(t.x, t.y), Edge(t.y, t.z), Edge(t.z, t.x)};
}

/// How many more triangles run along each edge than against it.
template <class Range>
std::map<Edge, int> surplusOf(const Range& triangles) {
    std::map<Edge, int> surplus;
    for (const glm::uvec3& t : triangles)
        for (const auto& [from, to] : edgesOf(t)) from < to ? ++surplus[{from, to}] : --surplus[{to, from}];
    return surplus;
}

/// Vertices at one place become one; triangles without an area or there twice are left out.
std::pair<Positions, Triangles> weld(const Mesh& mesh) {
    std::map<std::tuple<float, float, float>, std::uint32_t> places;
    std::set<std::array<std::uint32_t, 3>> seen;
    Positions positions;
    Triangles triangles;
    const auto placeOf = [&](std::uint32_t vertex) {
        const glm::vec3 p = mesh.positions[vertex];
        const auto [place, isNew] =
            places.try_emplace({p.x, p.y, p.z}, static_cast<std::uint32_t>(positions.size()));
        if (isNew) positions.push_back(p);
        return place->second;
    };
    for (const glm::uvec3& t : mesh.triangles) {
        const glm::uvec3 welded(placeOf(t.x), placeOf(t.y), placeOf(t.z));
        std::array<std::uint32_t, 3> corners{welded.x, welded.y, welded.z};
        std::ranges::sort(corners);
        const bool hasArea = corners[0] != corners[1] && corners[1] != corners[2];
        if (hasArea && seen.insert(corners).second) triangles.push_back(welded);
    }
    return {std::move(positions), std::move(triangles)};
}

/// For each vertex of an edge in `border`, the lowest vertex that its hole's rim leads to.
std::map<std::uint32_t, std::uint32_t> holesOf(const std::vector<Edge>& border) {
    std::map<std::uint32_t, std::uint32_t> hole;
    for (const auto& [from, to] : border) hole[from] = from, hole[to] = to;
    for (bool changed = true; changed;) {
        changed = false;
        for (const auto& [from, to] : border) {
            const std::uint32_t lowest = std::min(hole[from], hole[to]);
            changed |= hole[from] != lowest || hole[to] != lowest;
            hole[from] = hole[to] = lowest;
        }
    }
    return hole;
}

/// A fan round the middle of each hole's rim: whatever way the rim goes, its edges are then balanced.
void fillHoles(Positions& positions, Triangles& triangles) {
    std::vector<Edge> border; // as the fans run along it
    for (const auto& [edge, surplus] : surplusOf(triangles))
        for (int i = 0; i < std::abs(surplus); ++i)
            border.push_back(surplus > 0 ? Edge(edge.second, edge.first) : edge);
    const auto holes = holesOf(border);
    std::map<std::uint32_t, std::pair<glm::dvec3, double>> sums;
    for (const auto& [from, to] : border) {
        auto& [sum, count] = sums[holes.at(from)];
        sum += glm::dvec3(positions[from]), count += 1.0;
    }
    std::map<std::uint32_t, std::uint32_t> centres;
    for (const auto& [hole, sum] : sums) {
        centres[hole] = static_cast<std::uint32_t>(positions.size());
        positions.emplace_back(sum.first / sum.second);
    }
    for (const auto& [from, to] : border) triangles.emplace_back(from, to, centres[holes.at(from)]);
}

std::vector<glm::vec3> findInsides(const Mesh& mesh) {
    const Bounds bounds = boundsOf(mesh);
    std::vector<glm::vec3> insides;
    for (std::uint64_t i = 0; insides.size() < kInsides && i < 50 * kInsides; ++i) {
        RayNumbers numbers(1, i);
        const glm::vec3 p = bounds.lo + bounds.extent() * numbers.point();
        if (std::abs(windingNumber(mesh, p)) > 0.5) insides.push_back(p);
    }
    return insides;
}

} // namespace

ClosedMesh Placement::of(const ClosedMesh& closed) const {
    ClosedMesh placed{closed.name + ", " + name, moved(closed.mesh, scale, offset), closed.insides};
    for (glm::vec3& p : placed.insides) p = p * scale + offset;
    return placed;
}

ClosedMesh closedSphere() {
    return {"sphere", makeSphere(4), {{0.0f, 0.0f, 0.0f}, {0.1f, -0.2f, 0.05f}}};
}

ClosedMesh closedTorus() {
    ClosedMesh closed{"torus", makeTorus(0.7f, 0.25f, 96, 48), {}};
    for (int i = 0; i < 32; ++i) {
        const float angle = 0.2f * static_cast<float>(i);
        closed.insides.emplace_back(0.7f * std::cos(angle), 0.7f * std::sin(angle), 0.0f);
    }
    return closed;
}

ClosedMesh closedModel(const std::string& name, const std::string& path) {
    StageTimer timer;
    auto [positions, triangles] = weld(importModel(path, {}, timer).mesh);
    fillHoles(positions, triangles);
    Mesh mesh = makeIndexed(std::move(positions), std::move(triangles));
    std::vector<glm::vec3> insides = findInsides(mesh);
    return {name, std::move(mesh), std::move(insides)};
}

bool isClosed(const Mesh& mesh) {
    return std::ranges::all_of(surplusOf(mesh.triangles), [](const auto& edge) { return edge.second == 0; });
}

double windingNumber(const Mesh& mesh, const glm::vec3& point) {
    double angle = 0.0; // half of it
    for (const glm::uvec3& t : mesh.triangles) {
        const glm::dvec3 p(point);
        const glm::dvec3 a = glm::dvec3(mesh.positions[t.x]) - p, b = glm::dvec3(mesh.positions[t.y]) - p,
                         c = glm::dvec3(mesh.positions[t.z]) - p;
        const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
        angle += std::atan2(glm::dot(a, glm::cross(b, c)),
                            la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb);
    }
    return angle / (2.0 * std::numbers::pi);
}

} // namespace rt::test

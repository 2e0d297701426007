#pragma once
#include "formats/mesh.h"

#include <string>
#include <vector>

namespace rt::test {

/// A closed mesh and points inside it, from which every ray has to hit something.
struct ClosedMesh {
    std::string name;
    Mesh mesh;
    std::vector<glm::vec3> insides;
};

/// Where a mesh is put: p * scale + offset.
struct Placement {
    const char* name;
    float scale;
    glm::vec3 offset;

    ClosedMesh of(const ClosedMesh& closed) const;
};

inline const Placement kPlacements[] = {
    {"as it is", 1.0f, glm::vec3(0.0f)},
    {"scale 1e-12", 1e-12f, glm::vec3(0.0f)},
    {"scale 1e-6", 1e-6f, glm::vec3(0.0f)},
    {"scale 1e6", 1e6f, glm::vec3(0.0f)},
    {"scale 1e12", 1e12f, glm::vec3(0.0f)},
    {"offset 1e3 sizes", 0.3f, {300.0f, -170.0f, 20.0f}},
    {"offset 2e5 sizes", 1.0f, {148376.0f, 1234.0f, -223423.0f}},
};
/// Floats are whole numbers there: what is left of the sphere still has an inside, the torus' tube has none.
inline const Placement kSphereOnly = {"offset 1e7 sizes", 1.0f, {-1e7f, 3e6f, 9e6f}};

ClosedMesh closedSphere();
ClosedMesh closedTorus();
/// The model at `path`, imported and closed: vertices at the same place become one, triangles without an area
/// or there twice are left out, and each hole is filled by a fan round its centre.
ClosedMesh closedModel(const std::string& name, const std::string& path);

/// Whether as many triangles run along each edge in one direction as in the other.
bool isClosed(const Mesh& mesh);
/// How many times the mesh runs round the point: 0 outside. Sum of solid angles (van Oosterom & Strackee
/// 1983).
double windingNumber(const Mesh& mesh, const glm::vec3& point);

} // namespace rt::test

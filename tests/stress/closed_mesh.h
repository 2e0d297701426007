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

#include "tools/rt-import/repair_mesh.h"

#include "common/error.h"
#include "tools/rt-import/decimate_mesh.h"
#include "tools/rt-import/index_table.h"
#include "tools/rt-import/smooth_normals.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace rt {
namespace {

// The corners of a triangle, from the one with the lowest welded vertex on: the same for all that repeat it.
struct FaceKey {
    std::uint32_t material;
    std::array<std::uint32_t, 3> welded;
    std::array<glm::vec2, 3> texcoords;
    bool operator==(const FaceKey&) const = default;
};

FaceKey keyOf(const SceneSoup& soup, const Weld& weld, std::size_t triangle) {
    const glm::uvec3& t = weld.triangles[triangle];
    const int first = t.x < t.y && t.x < t.z ? 0 : t.y < t.z ? 1 : 2;
    FaceKey key{soup.triangleMaterial[triangle], {}, {}};
    for (int k = 0; k < 3; ++k) {
        const int corner = (first + k) % 3;
        const auto at = static_cast<std::size_t>(k);
        key.welded[at] = t[corner];
        if (!soup.texcoords.empty()) key.texcoords[at] = soup.texcoords[soup.triangles[triangle][corner]];
    }
    return key;
}

// Marks faces with two corners in one place, and all but the first of those that are the same.
std::vector<bool> findNeedless(const SceneSoup& soup, const Weld& weld, Ledger& ledger) {
    std::vector<bool> needless(soup.triangles.size(), false);
    IndexTable table(soup.triangles.size());
    for (std::uint32_t i = 0; i < soup.triangles.size(); ++i) {
        const glm::uvec3& t = weld.triangles[i];
        if (t.x == t.y || t.y == t.z || t.z == t.x) {
            ledger.add(Defect::NoArea, soup.origins[i]);
            needless[i] = true;
            continue;
        }
        const FaceKey key = keyOf(soup, weld, i);
        const std::uint64_t hash = mixHash(mixHash(mixHash(0, key.welded[0]), key.welded[1]), key.welded[2]);
        needless[i] = table.findOrInsert(hash, i, [&](std::uint32_t other) {
            return weld.triangles[other][0] + weld.triangles[other][1] + weld.triangles[other][2] ==
                       t.x + t.y + t.z &&
                   keyOf(soup, weld, other) == key;
        }) != i;
        if (needless[i]) ledger.add(Defect::Duplicates, soup.origins[i]);
    }
    return needless;
}

void drop(const std::vector<bool>& dropped, SceneSoup& soup, Weld& weld) {
    if (std::find(dropped.begin(), dropped.end(), true) == dropped.end()) return;
    removeTriangles(soup, dropped);
    removeMarked(weld.triangles, dropped);
}

// Splits the welded surface and turns the faces of the soup that have to be.
SplitSurface turnAndSplit(SceneSoup& soup, Weld& weld, Ledger& ledger) {
    SplitSurface surface = splitSurface(weld.triangles, findFaceNormals(weld.positions, weld.triangles));
    for (const std::uint32_t face : surface.turned) {
        std::swap(soup.triangles[face].y, soup.triangles[face].z);
        std::swap(weld.triangles[face].y, weld.triangles[face].z);
        ledger.add(Defect::Turned, soup.origins[face]);
    }
    for (const std::uint32_t face : surface.nonManifold) ledger.add(Defect::NonManifold, soup.origins[face]);
    return surface;
}

std::uint64_t wantedTriangles(const SceneSoup& soup, const RepairOptions& options) {
    const auto count = static_cast<double>(soup.triangles.size());
    const double part = std::max(std::floor(options.decimateRatio * count), 1.0);
    return std::min(static_cast<std::uint64_t>(part), options.maxTriangles);
}

void requireAtMost(std::uint64_t limit, const SceneSoup& soup, const std::string& path) {
    if (soup.triangles.size() > limit)
        throw Error(ErrorKind::LimitExceeded,
                    fmt::format("{}: {} triangles are left when no more edges can go; --max-triangles allows "
                                "{}; raise it, or join faces by --weld",
                                path, soup.triangles.size(), limit));
}

// Decimates if that is wanted, and splits what is left anew.
void decimateAsAsked(SceneSoup& soup, SplitSurface& surface, const RepairOptions& options,
                     const std::string& path, const std::function<void(double)>& progress,
                     RepairedSurface& result) {
    const std::uint64_t wanted = wantedTriangles(soup, options);
    if (wanted >= soup.triangles.size()) return;
    result.decimatedFrom = soup.triangles.size();
    decimate(soup, result.weld, std::move(surface), wanted, progress);
    requireAtMost(options.maxTriangles, soup, path);
    result.weld = weldPositions(soup, options.weldDistance);
    Ledger known; // the defects that are left were entered before
    surface = turnAndSplit(soup, result.weld, known);
}

// The last step: without these faces the surface round them would fall apart.
void dropFlatFaces(SceneSoup& soup, RepairedSurface& result, Ledger& ledger) {
    const std::vector<glm::vec3> normals = findFaceNormals(result.weld.positions, result.weld.triangles);
    std::vector<bool> flat(normals.size()), flatCorners(result.cornerNormals.size());
    for (std::size_t i = 0; i < flat.size(); ++i) {
        flat[i] = normals[i] == glm::vec3(0.0f);
        if (flat[i]) ledger.add(Defect::NoArea, soup.origins[i]);
    }
    for (std::size_t corner = 0; corner < flatCorners.size(); ++corner)
        flatCorners[corner] = flat[corner / 3];
    removeMarked(result.cornerNormals, flatCorners);
    drop(flat, soup, result.weld);
}

} // namespace

RepairedSurface repairSoup(SceneSoup& soup, const RepairOptions& options, const std::string& path,
                           Ledger& ledger, const std::function<void(double)>& progress) {
    requireTriangles(soup, path, ledger);
    requireFiniteExtent(soup, path);
    RepairedSurface result;
    result.weld = weldPositions(soup, options.weldDistance);
    progress(0.1);
    drop(findNeedless(soup, result.weld, ledger), soup, result.weld);
    requireTriangles(soup, path, ledger);
    progress(0.2);
    SplitSurface surface = turnAndSplit(soup, result.weld, ledger);
    progress(0.5);
    decimateAsAsked(
        soup, surface, options, path, [&](double part) { progress(0.5 + 0.4 * part); }, result);
    result.figures = surface.figures;
    result.generatedNormals = countMissingNormals(soup);
    if (result.generatedNormals > 0)
        result.cornerNormals = smoothNormals(result.weld.positions, std::move(surface),
                                             options.creaseDegrees.value_or(kUsualCrease));
    dropFlatFaces(soup, result, ledger);
    requireTriangles(soup, path, ledger);
    return result;
}

} // namespace rt

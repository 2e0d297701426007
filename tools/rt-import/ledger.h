#pragma once
#include <array>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace rt {

/// What can be wrong with the faces of a model.
enum class Defect : unsigned {
    PointsAndLines,
    MissingVertices,
    NotFinite,
    BadPolygons,
    NoArea,
    Duplicates,
    Turned,
    NonManifold,
    BadNormals,
    BadTexcoords,
};
inline constexpr std::size_t kDefects = 10;

/// Where a triangle comes from: a mesh of the file, by the number that the ledger gave it, and the face in
/// it, polygons counting once, from 0.
struct FaceOrigin {
    std::uint32_t mesh = 0;
    std::uint32_t face = 0;
    bool operator==(const FaceOrigin&) const = default;
};

/// Every defect that was found and mended, how often, and where first.
class Ledger {
public:
    static constexpr std::size_t kFirst = 5; ///< origins that are kept of each kind of defect

    struct Entry {
        std::uint64_t count = 0; ///< faces, instances counted each
        std::vector<FaceOrigin> first;
    };

    /// A number for a mesh that origins may speak of.
    std::uint32_t addMesh(std::string name);
    void add(Defect defect, FaceOrigin origin);

    const Entry& operator[](Defect defect) const { return entries_[static_cast<unsigned>(defect)]; }
    bool empty() const;
    /// "faces without area: 608 dropped (first: face 3, 4 of mesh 'ball')"; a line for each kind found.
    std::vector<std::string> lines() const;
    /// [{"defect", "count", "action", "first": [{"mesh", "face"}]}], the kinds that were found.
    nlohmann::json toJson() const;

private:
    std::string placesText(const std::vector<FaceOrigin>& origins) const;

    std::array<Entry, kDefects> entries_;
    std::vector<std::string> meshNames_;
};

} // namespace rt

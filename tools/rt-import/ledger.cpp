#include "tools/rt-import/ledger.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>

namespace rt {
namespace {

struct DefectText {
    const char* key;
    const char* what;
    const char* action;
};

// In the order of Defect.
constexpr std::array<DefectText, kDefects> kTexts{{
    {"pointsAndLines", "points and lines", "dropped"},
    {"missingVertices", "faces with vertices that do not exist", "dropped"},
    {"notFinite", "faces with vertices that are not finite", "dropped"},
    {"badPolygons", "polygons that cross or fold over themselves", "cut into fewer triangles"},
    {"noArea", "faces without area", "dropped"},
    {"duplicates", "faces that repeat another one", "dropped"},
    {"turned", "faces turned against their neighbours", "turned"},
    {"nonManifold", "faces at an edge of more than two", "kept, their vertices split"},
    {"badNormals", "faces with normals that are 0 or not finite", "given new normals"},
    {"badTexcoords", "faces with texture coordinates that are not finite", "given the coordinates 0, 0"},
}};

} // namespace

std::uint32_t Ledger::addMesh(std::string name) {
    meshNames_.push_back(std::move(name));
    return static_cast<std::uint32_t>(meshNames_.size() - 1);
}

void Ledger::add(Defect defect, FaceOrigin origin) {
    Entry& entry = entries_[static_cast<unsigned>(defect)];
    ++entry.count;
    if (entry.first.size() < kFirst &&
        std::find(entry.first.begin(), entry.first.end(), origin) == entry.first.end())
        entry.first.push_back(origin);
}

bool Ledger::empty() const {
    return std::all_of(entries_.begin(), entries_.end(), [](const Entry& entry) { return entry.count == 0; });
}

std::vector<std::string> Ledger::lines() const {
    std::vector<std::string> lines;
    for (std::size_t i = 0; i < kDefects; ++i)
        if (entries_[i].count > 0)
            lines.push_back(fmt::format("{}: {} {} (first: {})", kTexts[i].what, entries_[i].count,
                                        kTexts[i].action, placesText(entries_[i].first)));
    return lines;
}

std::string Ledger::placesText(const std::vector<FaceOrigin>& origins) const {
    std::string text;
    for (std::size_t i = 0; i < origins.size(); ++i) {
        const bool firstOfMesh = i == 0 || origins[i - 1].mesh != origins[i].mesh;
        text += fmt::format("{}{}{}", i == 0 ? "" : ", ", firstOfMesh ? "face " : "", origins[i].face);
        const bool lastOfMesh = i + 1 == origins.size() || origins[i + 1].mesh != origins[i].mesh;
        const std::string& mesh = meshNames_[origins[i].mesh];
        if (lastOfMesh && !mesh.empty()) text += fmt::format(" of mesh '{}'", mesh);
    }
    return text;
}

nlohmann::json Ledger::toJson() const {
    nlohmann::json list = nlohmann::json::array();
    for (std::size_t i = 0; i < kDefects; ++i) {
        if (entries_[i].count == 0) continue;
        nlohmann::json first = nlohmann::json::array();
        for (const FaceOrigin& origin : entries_[i].first)
            first.push_back({{"mesh", meshNames_[origin.mesh]}, {"face", origin.face}});
        list.push_back({{"defect", kTexts[i].key},
                        {"count", entries_[i].count},
                        {"action", kTexts[i].action},
                        {"first", std::move(first)}});
    }
    return list;
}

} // namespace rt

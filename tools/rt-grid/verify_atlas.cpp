#include "tools/rt-grid/verify_atlas.h"

#include "tools/rt-grid/verify_leaps.h"
#include "tools/rt-grid/verify_lists.h"
#include "tools/rt-grid/verify_source.h"

#include <fmt/format.h>

namespace rt {
namespace {

Proof proveCounts(const Atlas& atlas) {
    Faults faults = verifyCounts(atlas);
    faults.append(verifyBounds(atlas));
    return {"counts",
            fmt::format("{} leaves, {} references, pad, bounds", atlas.info.occupiedVoxels,
                        atlas.info.references),
            std::move(faults)};
}

Proof proveLists(const Atlas& atlas, WorkMeter& meter) {
    ListProof proof = verifyLists(atlas, meter);
    const std::uint64_t found = proof.needed - proof.faults.count;
    return {"lists",
            fmt::format("{} triangles need {} references; {} more are held", atlas.triangles.size(),
                        proof.needed, proof.held > found ? proof.held - found : 0),
            std::move(proof.faults)};
}

Proof proveLeaps(const Atlas& atlas, WorkMeter& meter) {
    if (hasBoxes(atlas.grid.dims.w)) {
        LeapProof proof = verifyBoxes(atlas, meter);
        return {"boxes", fmt::format("{} boxes of empty voxels and leaves", proof.leaps),
                std::move(proof.faults)};
    }
    LeapProof proof = verifyDistances(atlas, meter);
    return {"distances", fmt::format("{} voxels", proof.leaps), std::move(proof.faults)};
}

} // namespace

std::vector<Proof> verifyAtlas(const Atlas& atlas, const MeshFile* source, StageTimer& timer) {
    std::vector<Proof> proofs;
    const auto prove = [&](const char* stage, const auto& proofOf) {
        timer.begin(stage);
        proofs.push_back(proofOf());
        timer.end();
    };
    prove("counts", [&] { return proveCounts(atlas); });
    prove("lists", [&] { return proveLists(atlas, timer.meter()); });
    prove("leaps", [&] { return proveLeaps(atlas, timer.meter()); });
    if (source)
        prove("source", [&] {
            return Proof{"source", fmt::format("mesh {:016x}", source->contentHash),
                         verifySource(atlas, *source, timer.meter())};
        });
    return proofs;
}

} // namespace rt

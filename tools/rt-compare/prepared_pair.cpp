#include "tools/rt-compare/prepared_pair.h"

#include "formats/image_attributes.h"
#include "tools/rt-compare/pair_structure.h"

namespace rt {
namespace {

std::string prefixOf(const Picture& picture, std::size_t part) {
    if (picture.parts.size() == 1) return {};
    const std::string& name = picture.parts[part].name;
    return (name.empty() ? std::to_string(part) : name) + "/";
}

} // namespace

std::optional<int> samplesPerPixel(const Picture& picture) {
    const auto& ints = picture.parts.front().image.ints;
    const auto found = ints.find(kSamplesKey);
    return found == ints.end() ? std::nullopt : std::optional<int>(found->second);
}

PreparedPair preparePair(Picture&& a, Picture&& b, const PairOptions& options, const Picture* mask,
                         std::vector<Finding>& findings) {
    PreparedPair pair{std::move(a), std::move(b), {}, {}};
    for (Picture* picture : {&pair.a, &pair.b})
        for (PicturePart& part : picture->parts) selectChannels(part.image, options.channels);
    StructureComparer structure(options.allowed, findings);
    const std::size_t parts = structure.matchParts(pair.a, pair.b);
    bool comparable = structure.matchScales(pair.a, pair.b);
    for (std::size_t i = 0; i < parts; ++i)
        comparable &= structure.compareParts(pair.a.parts[i], pair.b.parts[i], prefixOf(pair.a, i));
    if (!comparable) return pair;

    std::uint64_t pixels = 0;
    for (std::size_t i = 0; i < parts; ++i) {
        PicturePart &partA = pair.a.parts[i], &partB = pair.b.parts[i];
        pair.regions.push_back(regionOf(partA.dataWindow, partB.dataWindow, options.region, mask));
        cutTo(partA, pair.regions.back());
        cutTo(partB, pair.regions.back());
        pixels += pair.regions.back().comparedCount();
    }
    if (pixels == 0)
        findings.push_back(
            {FindingKind::Nothing, "no pixel is left to compare after --crop, --mask and --ignore"});
    else
        for (std::size_t i = 0; i < parts; ++i)
            for (LayerPair& layer :
                 pairLayers(pair.a.parts[i].image, pair.b.parts[i].image, i, prefixOf(pair.a, i)))
                pair.layers.push_back(std::move(layer));
    return pair;
}

} // namespace rt

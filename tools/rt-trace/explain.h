#pragma once
#include "formats/atlas.h"
#include "tools/rt-trace/shader_resources.h"

namespace rt {

/// A part of an atlas, and whether the device gets it.
struct SectionUse {
    std::string name;
    std::uint64_t bytes = 0;
    bool uploaded = false;
};

/// Every array of the atlas, as it is used by variants of this plan. `ownEnvironment`: no other one takes the
/// place of the atlas'.
std::vector<SectionUse> sectionUses(const Atlas& atlas, const ResourcePlan& plan, bool ownEnvironment);

/// Text for people: each feature with its value and what it comes from, then each part of the atlas.
std::string explanation(const Atlas& atlas, const ResourcePlan& plan, bool ownEnvironment);

} // namespace rt

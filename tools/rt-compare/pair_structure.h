#pragma once
#include "tools/rt-compare/finding.h"

#include "formats/picture.h"

#include <string>
#include <vector>

namespace rt {

/// Names what two pictures differ in beside the values of their pixels. Every finding fails unless its kind
/// is allowed.
class StructureComparer {
public:
    StructureComparer(const AllowedKinds& allowed, std::vector<Finding>& findings)
        : allowed_(allowed), findings_(findings) {}

    /// Puts the parts of b into the order of a's; those that only one has go to the end. Returns how many
    /// match.
    std::size_t matchParts(Picture& a, Picture& b);
    /// Whether the values mean the same. Where that may differ, they are decoded to linear light.
    bool matchScales(Picture& a, Picture& b);
    /// Whether the pixels of the parts can be compared. `prefix` ("part/") stands before names.
    bool compareParts(const PicturePart& a, const PicturePart& b, const std::string& prefix);

private:
    bool isAllowed(FindingKind kind) const { return allowed_.contains(kind); }
    void add(FindingKind kind, const std::string& text);
    bool compareWindows(const PicturePart& a, const PicturePart& b);
    void compareChromaticities(const PicturePart& a, const PicturePart& b);
    void compareCamera(const PicturePart& a, const PicturePart& b, const char* name);
    void compareMatrix(const PicturePart& a, const PicturePart& b, const char* name);

    const AllowedKinds& allowed_;
    std::vector<Finding>& findings_;
    std::string where_; // "part NAME: ", where there are several
};

} // namespace rt

#pragma once
#include "formats/atlas.shared.h"

namespace rt {

/// Reads the triangles of a list, ascending.
class ListReader {
public:
    explicit ListReader(const std::uint32_t* list) : next_(list + kListHeaderWords) {}
    bool read(std::uint32_t& triangle) {
        if (!next_) return false;
        const std::uint32_t entry = *next_;
        next_ = entry & kLastInList ? nullptr : next_ + 1;
        triangle = entry & ~kLastInList;
        return true;
    }

private:
    const std::uint32_t* next_; // none after the last
};

/// Whether all triangles of one list are in the other.
inline bool isSubset(ListReader part, ListReader whole) {
    std::uint32_t wanted = 0;
    std::uint32_t found = 0;
    while (part.read(wanted)) {
        do
            if (!whole.read(found)) return false;
        while (found < wanted);
        if (found != wanted) return false;
    }
    return true;
}

} // namespace rt

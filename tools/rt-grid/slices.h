#pragma once
#include "formats/atlas.h"
#include "formats/image.h"

#include <string>
#include <vector>

namespace rt {

struct SlicePicture {
    std::string name; ///< of a file: "occupancy_z.png"
    Image image;
};

/// Cuts through the atlas across x, y and z at the part `at` of the grid along each axis, 0 to 1: for each,
/// one picture of occupancy (levels of leaves), distance (leapDistance() of empty voxels, in voxels of the
/// grid; not for uniform) and references (triangles that leaves list), as colours with a legend. Where voxels
/// are smaller than pixels, the greatest of several places counts, of distances the least. The atlas must
/// have passed validate().
std::vector<SlicePicture> slicesOf(const Atlas& atlas, const glm::dvec3& at);

} // namespace rt

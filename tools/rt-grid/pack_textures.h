#pragma once
#include "formats/mesh.h"

#include <cstdint>
#include <string>
#include <vector>

namespace rt {

inline constexpr std::uint32_t kMaxPageSide =
    16384; ///< GL limit of software GL; hardware allows as much or more
inline constexpr std::uint32_t kUsualPageSide = 4096;

/// Where all images of a mesh lie in pages of equal size.
struct PageLayout {
    std::vector<ImagePlace> places; ///< one per image of the mesh
    std::uint32_t width = 0;        ///< of a page, texels; all three are 0 if there are no images
    std::uint32_t height = 0;
    std::uint32_t pageCount = 0;

    std::uint64_t texelCount() const { return std::uint64_t(width) * height * pageCount; }
};

/// Places the images with their smaller levels, without overlap: on shelves, tallest first, in one page of
/// the smallest power of two that holds them all, or else in several of 4096 (more if one image is larger).
/// Rows that a single page does not use are cut. Throws Error{LimitExceeded}, message prefixed by `name`, for
/// an image over 16384 on a side.
PageLayout placeImages(const SharedSpan<MeshImage>& images, const std::string& name);

/// Returns the texels of all pages: pageCount * height * width, RGBA8, 0 where there is no image: each image
/// with its smaller levels, at levelRect() of its place. An empty layout gives none.
std::vector<std::uint32_t> paintPages(const Mesh& mesh, const PageLayout& layout);

} // namespace rt

#pragma once
#include "formats/image.h"
#include "tools/rt-trace/aovs.h"
#include "tools/rt-trace/camera.h"
#include "tools/rt-trace/film.h"

#include <optional>
#include <span>
#include <string>

namespace rt {

/// What a picture's channels and attributes say besides its pixels.
struct RenderRecord {
    CameraPose camera;
    std::uint64_t sceneHash = 0; ///< of the .rtmesh
    std::uint64_t atlasHash = 0; ///< of the .rtatlas
    std::string renderer = {};
    std::optional<double> renderTimeSeconds = {}; ///< absent: the picture is to be reproducible
    unsigned samples = 1;                         ///< per pixel, at most
    std::uint32_t seed = 0;
    unsigned aovs = kDefaultAovs;
    std::optional<glm::uvec4> window = {}; ///< [xy, zw): the pixels are those of this part of the picture
};

/// R, G, B, A and the record's AOVs: Z (depth along the view in world units, 0 where nothing was hit), N.X,
/// N.Y, N.Z and so on, see aovs.h; those for which there are no pixels are left out. `size` is that of the
/// whole picture.
///
/// Matrices transform row vectors, p' = p * M, as OpenEXR has it. worldToCamera: x to the right, y up, z
/// forward. worldToNDC: (0, 0) at the top left of the picture, (1, 1) at the bottom right; z = 1 / depth, as
/// there are no near and far planes, orthographic z = depth. A panorama has none.
Image toImage(glm::uvec2 size, const FilmPixels& pixels, const RenderRecord& record);

/// What a channel says of a pixel's samples.
enum class ChannelRule { Mean, FirstSample, Variance };
/// Nothing for a channel that toImage() does not make.
std::optional<ChannelRule> channelRule(const std::string& name);

/// Of each triangle of `ids` the material's index in the atlas; kNoTriangle stays what it is.
std::vector<std::uint32_t> materialsOf(std::span<const std::uint32_t> ids,
                                       std::span<const glm::uvec4> triangleVertices);

/// Pixels of which any channel is not a finite number.
std::size_t countNonFinite(const Image& image);

} // namespace rt

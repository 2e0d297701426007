#pragma once
#include "formats/image.h"
#include "tools/rt-trace/camera.h"
#include "tools/rt-trace/film.h"

namespace rt {

/// What a picture's attributes say besides its pixels.
struct RenderRecord {
    CameraPose camera;
    std::uint64_t sceneHash = 0; ///< of the .rtmesh
    std::uint64_t atlasHash = 0; ///< of the .rtatlas
    std::string renderer;
    std::optional<double> renderTimeSeconds; ///< absent: the picture is to be reproducible
};

/// R, G, B, A, Z (depth along the view in world units, 0 where nothing was hit), N.X, N.Y, N.Z and id.
///
/// Matrices transform row vectors, p' = p * M, as OpenEXR has it. worldToCamera: x to the right, y up, z
/// forward. worldToNDC: (0, 0) at the top left of the picture, (1, 1) at the bottom right; z = 1 / depth, as
/// there are no near and far planes.
Image toImage(glm::uvec2 size, const FilmPixels& pixels, const RenderRecord& record);

/// Pixels of which R, G, B or Z is not a finite number.
std::size_t countNonFinite(const FilmPixels& pixels);

} // namespace rt

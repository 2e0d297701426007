#pragma once
#include "formats/mesh.h"
#include "tools/rt-import/decode_image.h"
#include "tools/rt-import/read_materials.h"

#include <string>
#include <vector>

struct aiScene;

namespace rt {

class ModelFolder;

struct LoadedImages {
    std::vector<MeshImage> images;
    std::vector<std::uint32_t> pixels;
};

/// Decodes the textures of `materials` to RGBA8 and sets their images. There is one image for each file, way
/// of wrapping, colour space and kind of alpha; a file is decoded once for each of the latter that makes a
/// difference. A texture that is missing, unreadable or damaged is dropped and adds a warning, and so is a
/// bump map that holds heights. Throws Error{LimitExceeded} for an image wider or higher than kMaxImageSide
/// and for more than kMaxPixels in all, before they are decoded.
LoadedImages loadImages(const aiScene& scene, std::vector<MaterialSource>& materials,
                        const ModelFolder& folder, std::vector<std::string>& warnings);

} // namespace rt

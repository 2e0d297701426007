#include "tools/rt-trace/render_image.h"

#include <fmt/format.h>
#include <glm/mat4x4.hpp>

#include <algorithm>
#include <cmath>
#include <span>

namespace rt {
namespace {

ImageChannel floatChannel(const char* name, std::span<const glm::vec4> values, int component) {
    ImageChannel channel;
    channel.name = name;
    channel.values.reserve(values.size());
    for (const glm::vec4& value : values) channel.values.push_back(value[component]);
    return channel;
}

// glm's columns laid out one after the other are the rows of the matrix for row vectors.
std::vector<float> rowMajorForRowVectors(const glm::dmat4& matrix) {
    std::vector<float> values;
    for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 4; ++row) values.push_back(static_cast<float>(matrix[column][row]));
    return values;
}

glm::dmat4 cameraFromWorld(const CameraPose& pose, const CameraBasis& basis) {
    const glm::dmat3 axes = glm::transpose(glm::dmat3(basis.right, basis.up, basis.forward));
    glm::dmat4 matrix(axes);
    matrix[3] = glm::dvec4(-(axes * pose.eye), 1.0);
    return matrix;
}

// OpenEXR's picture coordinates: (0, 0) at the top left of the display window, (1, 1) at the bottom right.
glm::dmat4 ndcFromCamera(const CameraBasis& basis) {
    glm::dmat4 matrix(0.0);
    matrix[0][0] = 0.5 / basis.halfWidth;
    matrix[1][1] = -0.5 / basis.halfHeight;
    matrix[2] = glm::dvec4(0.5, 0.5, 0.0, 1.0); // w' = depth
    matrix[3][2] = 1.0;                         // z' = 1
    return matrix;
}

void addAttributes(Image& image, const RenderRecord& record) {
    const CameraBasis basis = basisOf(record.camera, double(image.width) / image.height);
    const glm::dmat4 worldToCamera = cameraFromWorld(record.camera, basis);
    image.matrices["worldToCamera"] = rowMajorForRowVectors(worldToCamera);
    image.matrices["worldToNDC"] = rowMajorForRowVectors(ndcFromCamera(basis) * worldToCamera);
    image.texts["software"] = "rt-tools " RT_VERSION;
    image.texts["rt:sceneHash"] = fmt::format("{:016x}", record.sceneHash);
    image.texts["rt:atlasHash"] = fmt::format("{:016x}", record.atlasHash);
    image.texts["rt:glRenderer"] = record.renderer;
    image.ints["samplesPerPixel"] = 1;
    image.ints["rt:seed"] = 0;
    if (record.renderTimeSeconds)
        image.floats["renderTimeSeconds"] = static_cast<float>(*record.renderTimeSeconds);
}

} // namespace

Image toImage(glm::uvec2 size, const FilmPixels& pixels, const RenderRecord& record) {
    Image image;
    image.width = size.x;
    image.height = size.y;
    image.channels = {floatChannel("R", pixels.colors, 0),     floatChannel("G", pixels.colors, 1),
                      floatChannel("B", pixels.colors, 2),     floatChannel("A", pixels.colors, 3),
                      floatChannel("N.X", pixels.surfaces, 0), floatChannel("N.Y", pixels.surfaces, 1),
                      floatChannel("N.Z", pixels.surfaces, 2), floatChannel("Z", pixels.surfaces, 3)};
    ImageChannel ids;
    ids.name = "id";
    ids.type = ImageChannel::Type::Uint;
    ids.uints = pixels.ids;
    image.channels.push_back(std::move(ids));
    std::sort(image.channels.begin(), image.channels.end(),
              [](const ImageChannel& a, const ImageChannel& b) { return a.name < b.name; });
    addAttributes(image, record);
    return image;
}

std::size_t countNonFinite(const FilmPixels& pixels) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < pixels.colors.size(); ++i) {
        const glm::vec4& color = pixels.colors[i];
        const bool finite = std::isfinite(color.r) && std::isfinite(color.g) && std::isfinite(color.b) &&
                            std::isfinite(pixels.surfaces[i].w);
        if (!finite) ++count;
    }
    return count;
}

} // namespace rt

#include "tools/rt-trace/render_image.h"

#include "formats/image_attributes.h"

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

ImageChannel uintChannel(const char* name, const std::vector<std::uint32_t>& values) {
    ImageChannel channel;
    channel.name = name;
    channel.type = ImageChannel::Type::Uint;
    channel.uints = values;
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
glm::dmat4 ndcFromCamera(const CameraBasis& basis, unsigned view) {
    glm::dmat4 matrix(0.0);
    matrix[0][0] = 0.5 / basis.halfWidth;
    matrix[1][1] = -0.5 / basis.halfHeight;
    if (view == kOrthographicView) {
        matrix[2][2] = 1.0;
        matrix[3] = glm::dvec4(0.5, 0.5, 0.0, 1.0);
        return matrix;
    }
    matrix[2] = glm::dvec4(0.5, 0.5, 0.0, 1.0); // w' = depth
    matrix[3][2] = 1.0;                         // z' = 1
    return matrix;
}

void addAttributes(Image& image, glm::uvec2 size, const RenderRecord& record) {
    const CameraBasis basis = basisOf(record.camera, double(size.x) / size.y);
    const glm::dmat4 worldToCamera = cameraFromWorld(record.camera, basis);
    image.matrices[kWorldToCameraKey] = rowMajorForRowVectors(worldToCamera);
    if (record.camera.view != kPanoramaView)
        image.matrices[kWorldToNdcKey] =
            rowMajorForRowVectors(ndcFromCamera(basis, record.camera.view) * worldToCamera);
    image.texts[kSoftwareKey] = "rt-tools " RT_VERSION;
    image.texts[kSceneHashKey] = fmt::format("{:016x}", record.sceneHash);
    image.texts[kAtlasHashKey] = fmt::format("{:016x}", record.atlasHash);
    image.texts[kRendererKey] = record.renderer;
    image.ints[kSamplesKey] = static_cast<std::int32_t>(record.samples);
    image.ints[kSeedKey] = static_cast<std::int32_t>(record.seed);
    if (record.renderTimeSeconds)
        image.floats[kRenderSecondsKey] = static_cast<float>(*record.renderTimeSeconds);
}

struct ChannelRow {
    unsigned aov; // 0: always there
    const char* name;
    const std::vector<glm::vec4> FilmPixels::*values;
    int component;
};
constexpr ChannelRow kChannels[] = {
    {0, "R", &FilmPixels::colors, 0},
    {0, "G", &FilmPixels::colors, 1},
    {0, "B", &FilmPixels::colors, 2},
    {0, "A", &FilmPixels::colors, 3},
    {kAovNormal, "N.X", &FilmPixels::surfaces, 0},
    {kAovNormal, "N.Y", &FilmPixels::surfaces, 1},
    {kAovNormal, "N.Z", &FilmPixels::surfaces, 2},
    {kAovDepth, "Z", &FilmPixels::surfaces, 3},
    {kAovPosition, "P.X", &FilmPixels::positions, 0},
    {kAovPosition, "P.Y", &FilmPixels::positions, 1},
    {kAovPosition, "P.Z", &FilmPixels::positions, 2},
    {kAovAlbedo, "albedo.R", &FilmPixels::albedos, 0},
    {kAovAlbedo, "albedo.G", &FilmPixels::albedos, 1},
    {kAovAlbedo, "albedo.B", &FilmPixels::albedos, 2},
    {kAovTexcoord, "uv.U", &FilmPixels::texcoords, 0},
    {kAovTexcoord, "uv.V", &FilmPixels::texcoords, 1},
    {kAovSteps, "steps", &FilmPixels::texcoords, 2},
    {kAovTests, "tests", &FilmPixels::texcoords, 3},
    {kAovTime, "time", &FilmPixels::albedos, 3},
};

void addChannels(Image& image, const FilmPixels& pixels, unsigned aovs) {
    for (const ChannelRow& row : kChannels) {
        const std::vector<glm::vec4>& values = pixels.*row.values;
        if ((row.aov == 0 || (aovs & row.aov)) && !values.empty())
            image.channels.push_back(floatChannel(row.name, values, row.component));
    }
    if (aovs & kAovId) image.channels.push_back(uintChannel("id", pixels.ids));
    if (aovs & kAovMaterial) image.channels.push_back(uintChannel("material", pixels.materials));
    if ((aovs & kAovVariance) && !pixels.variances.empty()) {
        ImageChannel& variance = image.channels.emplace_back();
        variance.name = "variance";
        variance.values = pixels.variances;
    }
    std::sort(image.channels.begin(), image.channels.end(),
              [](const ImageChannel& a, const ImageChannel& b) { return a.name < b.name; });
}

} // namespace

Image toImage(glm::uvec2 size, const FilmPixels& pixels, const RenderRecord& record) {
    const glm::uvec4 window = record.window.value_or(glm::uvec4(0, 0, size));
    Image image;
    image.width = window.z - window.x;
    image.height = window.w - window.y;
    if (window != glm::uvec4(0, 0, size))
        image.frame = ImageFrame{static_cast<std::int32_t>(window.x), static_cast<std::int32_t>(window.y),
                                 size.x, size.y};
    addChannels(image, pixels, record.aovs);
    addAttributes(image, size, record);
    return image;
}

std::optional<ChannelRule> channelRule(const std::string& name) {
    if (name == "id" || name == "material") return ChannelRule::FirstSample;
    if (name == "variance") return ChannelRule::Variance;
    for (const ChannelRow& row : kChannels)
        if (name == row.name)
            return row.aov & kFirstSampleAovs ? ChannelRule::FirstSample : ChannelRule::Mean;
    return std::nullopt;
}

std::vector<std::uint32_t> materialsOf(std::span<const std::uint32_t> ids,
                                       std::span<const glm::uvec4> triangleVertices) {
    std::vector<std::uint32_t> materials;
    materials.reserve(ids.size());
    for (const std::uint32_t id : ids)
        materials.push_back(id < triangleVertices.size() ? triangleVertices[id].w : id);
    return materials;
}

std::size_t countNonFinite(const Image& image) {
    std::vector<bool> bad(image.pixelCount());
    for (const ImageChannel& channel : image.channels)
        for (std::size_t i = 0; i < channel.values.size(); ++i)
            if (!std::isfinite(channel.values[i])) bad[i] = true;
    return static_cast<std::size_t>(std::count(bad.begin(), bad.end(), true));
}

} // namespace rt

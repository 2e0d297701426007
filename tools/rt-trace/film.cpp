#include "tools/rt-trace/film.h"

#include "common/error.h"
#include "formats/gpu_interface.shared.h"

#include <epoxy/gl.h>
#include <fmt/format.h>

#include <algorithm>

namespace rt {
namespace {

struct ImageFormat {
    GLenum stored, format, type;
    unsigned words; // of a texel
};

// By image unit.
constexpr std::array<ImageFormat, 8> kFormats = {{
    {GL_RGBA32F, GL_RGBA, GL_FLOAT, 4},                 // RT_IMAGE_COLOR
    {GL_RGBA32F, GL_RGBA, GL_FLOAT, 4},                 // RT_IMAGE_SURFACE
    {GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, 1},     // RT_IMAGE_ID
    {GL_RGBA32UI, GL_RGBA_INTEGER, GL_UNSIGNED_INT, 4}, // RT_IMAGE_COUNTERS
    {GL_RG32F, GL_RG, GL_FLOAT, 2},                     // RT_IMAGE_MOMENTS
    {GL_RGBA32F, GL_RGBA, GL_FLOAT, 4},                 // RT_IMAGE_ALBEDO
    {GL_RGBA32F, GL_RGBA, GL_FLOAT, 4},                 // RT_IMAGE_POSITION
    {GL_RGBA32F, GL_RGBA, GL_FLOAT, 4},                 // RT_IMAGE_TEXCOORD
}};

std::size_t pixelsIn(const glm::uvec4& window) {
    return std::size_t(window.z - window.x) * (window.w - window.y);
}

std::vector<unsigned> unitsFor(const SceneFeatures& features) {
    std::vector<unsigned> units = {RT_IMAGE_COLOR, RT_IMAGE_SURFACE, RT_IMAGE_ID};
    if (features.countWork) units.push_back(RT_IMAGE_COUNTERS);
    if (features.hasMoments) units.push_back(RT_IMAGE_MOMENTS);
    if (features.hasAovs) units.insert(units.end(), {RT_IMAGE_ALBEDO, RT_IMAGE_POSITION, RT_IMAGE_TEXCOORD});
    return units;
}

// Exact where there is one sample.
void divide(std::vector<glm::vec4>& sums, std::span<const std::uint32_t> samples, const glm::bvec4& which) {
    for (std::size_t i = 0; i < sums.size(); ++i)
        for (int c = 0; c < 4; ++c)
            if (which[c] && samples[i] > 1) sums[i][c] /= static_cast<float>(samples[i]);
}

} // namespace

double varianceOfMean(const glm::vec2& moments, std::uint32_t samples) {
    if (samples < 2) return 0.0;
    const double n = samples;
    const double mean = moments.y / n;
    return std::max(moments.x / n - mean * mean, 0.0) / (n - 1.0);
}

Film::Film(const glm::uvec4& window, const SceneFeatures& features, const GlLimits& limits)
    : window_(window) {
    const glm::uvec2 size(window.z - window.x, window.w - window.y);
    if (size.x > limits.textureSize2D || size.y > limits.textureSize2D)
        throw Error(ErrorKind::LimitExceeded,
                    fmt::format("--size {}x{}: this device renders at most {}x{}; render parts with --crop",
                                size.x, size.y, limits.textureSize2D, limits.textureSize2D));
    for (const unsigned unit : unitsFor(features)) {
        const ImageFormat& format = kFormats[unit];
        images_[unit] = createTexture2D(format.stored, size.x, size.y);
        glClearTexImage(images_[unit].name(), 0, format.format, format.type, nullptr); // to 0
    }
    checkGl("clearing the film");
}

std::uint64_t Film::bytesFor(const glm::uvec4& window, const SceneFeatures& features) {
    std::uint64_t words = 0;
    for (const unsigned unit : unitsFor(features)) words += kFormats[unit].words;
    return pixelsIn(window) * words * sizeof(std::uint32_t);
}

void Film::bind() const {
    for (unsigned unit = 0; unit < kImageCount; ++unit)
        if (images_[unit].name())
            glBindImageTexture(unit, images_[unit].name(), 0, GL_FALSE, 0, GL_READ_WRITE,
                               kFormats[unit].stored);
    checkGl("binding the film");
}

glm::uvec4 Film::inImages(const glm::uvec4& window) const {
    return window - glm::uvec4(window_.x, window_.y, window_.x, window_.y);
}

// Empty where the film has no such image.
template <class T>
std::vector<T> Film::readImage(unsigned unit, const glm::uvec4& window) const {
    if (!images_[unit].name()) return {};
    std::vector<T> texels(pixelsIn(window));
    readTexels(images_[unit], inImages(window), kFormats[unit].format, kFormats[unit].type,
               std::as_writable_bytes(std::span(texels)));
    return texels;
}

FilmPixels Film::read(const glm::uvec4& window, std::span<const std::uint32_t> samples) const {
    FilmPixels pixels{readImage<glm::vec4>(RT_IMAGE_COLOR, window),
                      readImage<glm::vec4>(RT_IMAGE_SURFACE, window),
                      readImage<std::uint32_t>(RT_IMAGE_ID, window)};
    pixels.albedos = readImage<glm::vec4>(RT_IMAGE_ALBEDO, window);
    pixels.positions = readImage<glm::vec4>(RT_IMAGE_POSITION, window);
    pixels.texcoords = readImage<glm::vec4>(RT_IMAGE_TEXCOORD, window);
    divide(pixels.colors, samples, glm::bvec4(true));
    divide(pixels.albedos, samples, glm::bvec4(true));
    divide(pixels.texcoords, samples, glm::bvec4(false, false, true, true));
    const std::vector<glm::vec2> moments = readMoments(window);
    for (std::size_t i = 0; i < moments.size(); ++i)
        pixels.variances.push_back(static_cast<float>(varianceOfMean(moments[i], samples[i])));
    return pixels;
}

std::vector<glm::uvec4> Film::readCounters(const glm::uvec4& window) const {
    return readImage<glm::uvec4>(RT_IMAGE_COUNTERS, window);
}

std::vector<glm::vec2> Film::readMoments(const glm::uvec4& window) const {
    return readImage<glm::vec2>(RT_IMAGE_MOMENTS, window);
}

bool Film::isSaved(unsigned unit) const {
    return images_[unit].name() && unit != RT_IMAGE_COUNTERS;
}

std::vector<CheckpointPlane> Film::save(const glm::uvec4& window) const {
    std::vector<CheckpointPlane> planes;
    for (unsigned unit = 0; unit < kImageCount; ++unit) {
        if (!isSaved(unit)) continue;
        CheckpointPlane& plane = planes.emplace_back(CheckpointPlane{unit});
        plane.words.resize(pixelsIn(window) * kFormats[unit].words);
        readTexels(images_[unit], inImages(window), kFormats[unit].format, kFormats[unit].type,
                   std::as_writable_bytes(std::span(plane.words)));
    }
    return planes;
}

bool Film::restore(const glm::uvec4& window, std::span<const CheckpointPlane> planes) const {
    std::size_t wanted = 0;
    for (unsigned unit = 0; unit < kImageCount; ++unit) wanted += isSaved(unit);
    const bool same = std::all_of(planes.begin(), planes.end(), [&](const CheckpointPlane& plane) {
        return plane.image < kImageCount && isSaved(plane.image) &&
               plane.words.size() == pixelsIn(window) * kFormats[plane.image].words;
    });
    if (!same || planes.size() != wanted) return false;
    for (const CheckpointPlane& plane : planes)
        writeTexels(images_[plane.image], inImages(window), kFormats[plane.image].format,
                    kFormats[plane.image].type, std::as_bytes(std::span(plane.words)));
    return true;
}

} // namespace rt

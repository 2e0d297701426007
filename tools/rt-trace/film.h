#pragma once
#include "formats/checkpoint_file.h"
#include "tools/rt-trace/gl_limits.h"
#include "tools/rt-trace/gl_objects.h"

#include <array>
#include <glm/vec2.hpp>
#include <glm/vec4.hpp>
#include <span>
#include <vector>

namespace rt {

/// What a picture is read back as: one value per pixel, row by row from the top; means over its samples but
/// where it says otherwise. What the film lacks is empty.
struct FilmPixels {
    std::vector<glm::vec4> colors;         ///< linear RGB; A = part of the samples that hit something
    std::vector<glm::vec4> surfaces;       ///< normal, and depth in world units, of the first sample
    std::vector<std::uint32_t> ids;        ///< triangle or kNoTriangle, of the first sample
    std::vector<glm::vec4> albedos = {};   ///< rgb; a: ticks of the device's clock
    std::vector<glm::vec4> positions = {}; ///< xyz world, of the first sample
    std::vector<glm::vec4> texcoords = {}; ///< U, V of the first sample; steps and tests per sample
    std::vector<float> variances =
        {}; ///< of the mean of the luminance, estimated; 0 where there is one sample
    std::vector<std::uint32_t> materials = {}; ///< see materialsOf()
};

/// Estimated from the sums of a value squared and of the value over so many samples; 0 for one sample.
double varianceOfMean(const glm::vec2& moments, std::uint32_t samples);

/// The images that a variant of the render shader writes.
class Film {
public:
    /// Of the pixels of `window`, [xy, zw), with the images that `features` name. Throws
    /// Error{LimitExceeded} for a size that the device does not allow.
    Film(const glm::uvec4& window, const SceneFeatures& features, const GlLimits& limits);
    /// What its images take on the device.
    static std::uint64_t bytesFor(const glm::uvec4& window, const SceneFeatures& features);
    void bind() const;
    /// Here and below `window`, [xy, zw), is part of the film's and counted from the whole picture's corner.
    /// `samples` has as many values: how many samples each pixel has.
    FilmPixels read(const glm::uvec4& window, std::span<const std::uint32_t> samples) const;
    /// Rays, steps and triangle tests of each pixel; only of a film that counts work.
    std::vector<glm::uvec4> readCounters(const glm::uvec4& window) const;
    /// Sums of the luminance squared and of the luminance; only of a film that has moments.
    std::vector<glm::vec2> readMoments(const glm::uvec4& window) const;

    /// What the images hold in a window, as it is.
    std::vector<CheckpointPlane> save(const glm::uvec4& window) const;
    /// Puts back what save() gave for such a film and window. False, and nothing done, if these are the
    /// planes of another one.
    bool restore(const glm::uvec4& window, std::span<const CheckpointPlane> planes) const;

private:
    static constexpr std::size_t kImageCount = kCheckpointPlanes;
    bool isSaved(unsigned unit) const;
    template <class T>
    std::vector<T> readImage(unsigned unit, const glm::uvec4& window) const;
    /// Where these pixels are in the images.
    glm::uvec4 inImages(const glm::uvec4& window) const;

    glm::uvec4 window_;

    std::array<GlTexture, kImageCount> images_; // by image unit; those that are not there have no name
};

} // namespace rt

#pragma once
#include "tools/rt-trace/gl_limits.h"
#include "tools/rt-trace/gl_objects.h"

#include <glm/vec4.hpp>
#include <vector>

namespace rt {

/// What a picture is read back as: one value per pixel, row by row from the top.
struct FilmPixels {
    std::vector<glm::vec4> colors;   ///< linear RGB; A = 1 where something was hit
    std::vector<glm::vec4> surfaces; ///< normal, and depth in world units
    std::vector<std::uint32_t> ids;  ///< triangle or kNoTriangle
};

/// The images that the render shader writes.
class Film {
public:
    /// Throws Error{LimitExceeded} for a size that the device does not allow.
    Film(glm::uvec2 size, bool countWork, const GlLimits& limits);
    void bind() const;
    FilmPixels read() const;
    /// Rays, steps and triangle tests of each pixel; only of a film that counts work.
    std::vector<glm::uvec4> readCounters() const;

private:
    glm::uvec2 size_;
    GlTexture color_, surface_, id_, counters_;
};

} // namespace rt

#pragma once
#include "tools/rt-trace/gl_objects.h"

#include <array>
#include <glm/vec3.hpp>

namespace rt {

/// Fills buffers and textures of the device from host memory. All cores copy into one piece of a buffer that
/// stays mapped while the device takes the pieces before it: drivers' own copies run on one core.
class UploadRing {
public:
    /// Enough that neither the cores nor the device wait for each other's first byte.
    static constexpr std::size_t kPieceBytes = 4u << 20;

    /// `pieceBytes` is at least a row of any texture.
    explicit UploadRing(std::size_t pieceBytes = kPieceBytes);

    /// A buffer as createBuffer() makes it, but it cannot be updated.
    GlBuffer createBuffer(std::span<const std::byte> bytes);
    /// Fills a 3D or 2D array texture of 32-bit texels. `format` and `type` describe `texels` as GL does.
    void fillTexture(const GlTexture& texture, const glm::uvec3& size, GlEnum format, GlEnum type,
                     std::span<const std::uint32_t> texels);
    /// Waits until the device has taken everything.
    void finish();

private:
    std::size_t fillPiece(std::span<const std::byte> bytes);
    void handOverPiece();

    static constexpr std::size_t kPieces = 4;
    std::size_t pieceBytes_;
    StagingBuffer staging_;
    std::array<GlFence, kPieces> taken_;
    std::size_t piece_ = 0; // the next one to fill
};

} // namespace rt

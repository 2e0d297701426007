#include "tools/rt-trace/upload_ring.h"

#include <epoxy/gl.h>
#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cassert>
#include <cstring>

namespace rt {
namespace {

constexpr std::size_t kCopyBytes = 256u << 10; // of one core at a time
constexpr std::size_t kPieceAlignment = 64;

void copyOnAllCores(std::byte* target, std::span<const std::byte> bytes) {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, bytes.size(), kCopyBytes), [&](const auto& range) {
        std::memcpy(target + range.begin(), bytes.data() + range.begin(), range.size());
    });
}

} // namespace

UploadRing::UploadRing(std::size_t pieceBytes)
    : pieceBytes_((pieceBytes + kPieceAlignment - 1) / kPieceAlignment * kPieceAlignment),
      staging_(createStagingBuffer(kPieces * pieceBytes_)) {}

// Returns the piece's offset in the ring.
std::size_t UploadRing::fillPiece(std::span<const std::byte> bytes) {
    assert(bytes.size() <= pieceBytes_);
    taken_[piece_].wait();
    const std::size_t offset = piece_ * pieceBytes_;
    copyOnAllCores(staging_.mapped + offset, bytes);
    return offset;
}

void UploadRing::handOverPiece() {
    taken_[piece_] = GlFence::insert();
    glFlush(); // the device is to begin now
    piece_ = (piece_ + 1) % kPieces;
}

GlBuffer UploadRing::createBuffer(std::span<const std::byte> bytes) {
    GlBuffer buffer = createOutputBuffer(bytes.size() + kReadableBeyond);
    for (std::size_t first = 0; first < bytes.size(); first += pieceBytes_) {
        const auto piece = bytes.subspan(first, std::min(pieceBytes_, bytes.size() - first));
        const std::size_t offset = fillPiece(piece);
        glCopyNamedBufferSubData(staging_.buffer.name(), buffer.name(), static_cast<GLintptr>(offset),
                                 static_cast<GLintptr>(first), static_cast<GLsizeiptr>(piece.size()));
        handOverPiece();
    }
    checkGl(fmt::format("uploading a buffer of {} bytes", bytes.size()));
    return buffer;
}

// A piece is some whole layers, or some rows of one layer.
void UploadRing::fillTexture(const GlTexture& texture, const glm::uvec3& size, GlEnum format, GlEnum type,
                             std::span<const std::uint32_t> texels) {
    const std::size_t most = pieceBytes_ / (size.x * sizeof(std::uint32_t)); // rows
    assert(most > 0);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
    glBindBuffer(GL_PIXEL_UNPACK_BUFFER, staging_.buffer.name());
    for (std::size_t row = 0; row < std::size_t(size.y) * size.z;) {
        const std::size_t y = row % size.y, z = row / size.y;
        const std::size_t rows = std::min(most, size.y - y); // all of a layer's where several layers fit
        const std::size_t layers = std::clamp<std::size_t>(most / size.y, 1, size.z - z);
        const std::size_t offset =
            fillPiece(std::as_bytes(texels.subspan(row * size.x, layers * rows * size.x)));
        glTextureSubImage3D(texture.name(), 0, 0, static_cast<GLint>(y), static_cast<GLint>(z),
                            static_cast<GLsizei>(size.x), static_cast<GLsizei>(rows),
                            static_cast<GLsizei>(layers), format, type,
                            reinterpret_cast<const void*>(offset));
        handOverPiece();
        row += layers * rows;
    }
    glBindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
    checkGl(fmt::format("uploading a texture of {}x{}x{}", size.x, size.y, size.z));
}

void UploadRing::finish() {
    for (GlFence& fence : taken_) fence.wait();
    checkGl("uploading the atlas");
}

} // namespace rt

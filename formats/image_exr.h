#pragma once
#include "formats/image.h"
#include "formats/picture.h"

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

namespace rt {

/// The bytes of a single-part scanline EXR, ZIP-compressed. Same image, same bytes. Finite values beyond the
/// range of a Half channel become +-65504, the largest it holds.
std::vector<std::byte> encodeExr(const Image& image);

/// encodeExr() of a picture that is never in memory as a whole: it is given some rows after the other.
class ExrEncoder {
public:
    /// Of a picture like `header`, whose channels need no values.
    explicit ExrEncoder(const Image& header);
    ~ExrEncoder();
    /// The next rows, in channels as the header has them.
    void add(const Image& rows);
    /// Once all rows are there.
    std::vector<std::byte> finish();

private:
    struct State;
    std::unique_ptr<State> state_;
};

/// Decodes all channels of a single-part EXR (scanline or tiled) whose compression is NONE, RLE, ZIPS or ZIP.
/// Safe for untrusted bytes. Throws Error{InvalidContent} prefixed by `name`, Error{LimitExceeded} above 2^28
/// pixels.
Image decodeExr(std::span<const std::byte> bytes, const std::string& name);

/// Rows of a picture, counted from its own first one.
struct ExrRowRange {
    std::uint32_t first = 0, count = 0;
};
/// What decodeExr() gives, but without values and with its frame.
Image decodeExrHeader(std::span<const std::byte> bytes, const std::string& name);
/// decodeExr() of some rows of a scanline picture, as a picture of its own with its frame.
Image decodeExrRows(std::span<const std::byte> bytes, const std::string& name, const ExrRowRange& rows);

/// Decodes all parts of an EXR (scanline or tiled, of which the full size is read). A channel that has one
/// value for a block of pixels has it for each of them here. Safe for untrusted bytes, unless
/// limits.allCompressions. Throws Error{InvalidContent} or Error{LimitExceeded} prefixed by `name`.
std::vector<PicturePart> decodeExrParts(std::span<const std::byte> bytes, const std::string& name,
                                        const PictureLimits& limits);

/// decodeExr() of a file; "-" is standard input. Throws Error{FileAccess} too.
Image readExr(const std::string& path);

} // namespace rt

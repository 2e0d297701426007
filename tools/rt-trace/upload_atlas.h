#pragma once
#include "tools/rt-trace/gl_limits.h"
#include "tools/rt-trace/upload_ring.h"

#include <utility>
#include <vector>

namespace rt {

/// An atlas in the device's memory, as far as one plan needs it.
class GpuAtlas {
public:
    /// Makes everything current that shaders of the plan read, except camera and lights, or rays and hits.
    void bind() const;

private:
    friend GpuAtlas uploadAtlas(const Atlas&, const ResourcePlan&, const GlLimits&, unsigned,
                                const std::string&, std::size_t);
    GlBuffer grid_;
    std::vector<std::pair<unsigned, GlBuffer>> buffers_;   // binding, buffer
    std::vector<std::pair<unsigned, GlTexture>> textures_; // unit, texture
};

/// How much of the atlas the plan brings to the device.
std::uint64_t uploadedBytes(const Atlas& atlas, const ResourcePlan& plan);

/// Uploads from the spans through an UploadRing of such pieces. The shader's grid.counts.w becomes
/// `lightCount`. Only the arrays' sizes must be right, see validateSizes(): what is in them is not looked at.
/// Throws Error{LimitExceeded}, prefixed by `name` where a limit of the device is known beforehand.
GpuAtlas uploadAtlas(const Atlas& atlas, const ResourcePlan& plan, const GlLimits& limits,
                     unsigned lightCount, const std::string& name,
                     std::size_t pieceBytes = UploadRing::kPieceBytes);

} // namespace rt

#pragma once
#include "formats/image.h"

#include <cstdint>

namespace rt::bench {

/// Each pixel the mean of side*side ones, in the channels R, G, B and A; the others, and the attributes, say
/// nothing of such a mean and are dropped. Throws Error{InvalidContent}, message prefixed by `name`, if the
/// blocks do not fill the image or there is none of those channels.
Image averageBlocks(const Image& image, std::uint32_t side, const std::string& name);

} // namespace rt::bench

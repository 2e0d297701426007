#pragma once
#include <cstdint>
#include <optional>
#include <string>

namespace rt {

/// How large buffers and textures may be.
struct DeviceLimits {
    std::string name;
    std::uint64_t bufferBytes = 0; ///< of a storage buffer that a shader sees in one piece
    std::uint64_t textureBytes = 0;
    unsigned textureSide3D = 0;
    unsigned textureSide2D = 0;
    unsigned arrayLayers = 0;
};

/// What every OpenGL 4.5 device has at least.
DeviceLimits guaranteedLimits();

/// Those of this machine's first device with OpenGL 4.5, hardware before software; nothing where there is
/// none.
std::optional<DeviceLimits> limitsOfThisDevice();

} // namespace rt

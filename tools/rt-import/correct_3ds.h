#pragma once

struct aiScene;

namespace rt {

/// Assimp takes the lens of a camera of a 3DS file, a focal length in mm for a film 36 mm wide, for an angle
/// in degrees, and starts its roll from +y, though the format's z axis points up. Sets both right.
void correct3dsCameras(aiScene& scene);

} // namespace rt

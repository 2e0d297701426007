#pragma once
#include <cstddef>
#include <span>

struct aiScene;

namespace rt {

/// What Assimp makes of a 3DS file otherwise: it takes a camera's lens, a focal length in mm for a film 36 mm
/// wide, for an angle in degrees; it starts a camera's roll from +y, though the format's z axis points up;
/// its lights get dimmer with the distance, which the format's do not; and where no face has a smoothing
/// group it smooths all edges, where the format means flat faces. Sets all of that right. A file without
/// smoothing groups gets flat faces or, unless `flat`, no normals. `file` is the file's content.
void correct3ds(std::span<const std::byte> file, bool flat, aiScene& scene);

} // namespace rt

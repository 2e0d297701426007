#pragma once
#include "formats/mesh.h"

#include <embree3/rtcore.h>

namespace rt::test {

/// The mesh's triangles in their order as one geometry of high build quality, not committed yet. The caller
/// sets its flags, commits and releases it.
RTCScene newEmbreeScene(RTCDevice device, const Mesh& mesh);

} // namespace rt::test

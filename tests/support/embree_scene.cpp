#include "tests/support/embree_scene.h"

#include <cstring>

namespace rt::test {

RTCScene newEmbreeScene(RTCDevice device, const Mesh& mesh) {
    RTCScene scene = rtcNewScene(device);
    rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_HIGH);
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    void* positions = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12,
                                              mesh.positions.size());
    std::memcpy(positions, mesh.positions.data(), mesh.positions.size_bytes());
    void* triangles = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12,
                                              mesh.triangles.size());
    std::memcpy(triangles, mesh.triangles.data(), mesh.triangles.size_bytes());
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
    return scene;
}

} // namespace rt::test

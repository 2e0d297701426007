#pragma once
#include <cstdlib>
#include <string>

namespace rt::test {

/// Path of a file of the scene collection, which may be absent: tests that need it skip then.
inline std::string scenePath(const std::string& relative) {
    const char* folder = std::getenv("RT_SCENES_DIR");
    return std::string(folder && *folder ? folder : RT_SCENES_DIR) + "/" + relative;
}

/// The model that is part of the repository: 57,184 triangles, 608 of them without area, 28 materials, 17
/// textures.
inline std::string poolTablePath() {
    return RT_SOURCE_DIR "/pipelines/quickstart/poolTable/poolTable.obj";
}

} // namespace rt::test

#include "tools/rt-grid/libraries.h"

#include <fmt/format.h>
#include <glm/glm.hpp>
#include <openvdb/version.h>
#include <tbb/version.h>

namespace rt {

std::string gridLibraries() {
    return fmt::format("OpenVDB {}\noneTBB {}.{}\nGLM {}.{}.{}.{}", openvdb::getLibraryVersionString(),
                       TBB_VERSION_MAJOR, TBB_VERSION_MINOR, GLM_VERSION_MAJOR, GLM_VERSION_MINOR,
                       GLM_VERSION_PATCH, GLM_VERSION_REVISION);
}

} // namespace rt

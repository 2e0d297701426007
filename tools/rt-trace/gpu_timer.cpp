#include "tools/rt-trace/gpu_timer.h"

#include <epoxy/gl.h>

namespace rt {

GpuTimer::GpuTimer(bool software) : software_(software) {
    if (software) return;
    GLuint name = 0;
    glCreateQueries(GL_TIME_ELAPSED, 1, &name);
    query_ = GlQuery(name);
}

void GpuTimer::begin() {
    glFinish();
    start_ = std::chrono::steady_clock::now();
    if (!software_) glBeginQuery(GL_TIME_ELAPSED, query_.name());
}

double GpuTimer::endMs() {
    GLuint64 nanoseconds = 0;
    if (!software_) glEndQuery(GL_TIME_ELAPSED);
    glFinish();
    if (software_)
        return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start_).count();
    glGetQueryObjectui64v(query_.name(), GL_QUERY_RESULT, &nanoseconds);
    return static_cast<double>(nanoseconds) * 1e-6;
}

} // namespace rt

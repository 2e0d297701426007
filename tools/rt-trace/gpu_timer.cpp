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
    if (!software_) return glBeginQuery(GL_TIME_ELAPSED, query_.name());
    glFinish();
    start_ = Clock::now();
}

void GpuTimer::end() {
    if (!software_) return glEndQuery(GL_TIME_ELAPSED);
    glFinish();
    end_ = Clock::now();
}

double GpuTimer::elapsedMs() const {
    if (software_) return std::chrono::duration<double, std::milli>(end_ - start_).count();
    GLuint64 nanoseconds = 0;
    glGetQueryObjectui64v(query_.name(), GL_QUERY_RESULT, &nanoseconds);
    return static_cast<double>(nanoseconds) * 1e-6;
}

} // namespace rt

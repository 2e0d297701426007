#pragma once
#include "formats/image.h"
#include "tools/rt-trace/load_scene.h"
#include "tools/rt-trace/picture_setup.h"
#include "tools/rt-trace/render_loop.h"

#include <nlohmann/json_fwd.hpp>
#include <optional>

namespace rt {

/// A picture that is finished, or as far as it was to go.
struct Picture {
    FilmPixels pixels;
    TileSamples tiles;
    LoopFigures figures;
    PassCounts passes;      ///< of --kernel multipass
    double earlierMs = 0.0; ///< gpuMs of the runs that it was resumed from
    std::optional<WorkTotals> work = {};
    StageTimes stageTimes = {};        ///< of the pass that counted `work`
    double heatMost = 0.0;             ///< what --heat shows in yellow
    std::size_t nonFinite = 0;         ///< pixels of the written image, see countNonFinite()
    std::vector<double> passesMs = {}; ///< of --repeat; sorted, gpuMs is their median
};

/// Renders with what has been brought to the device. Resumes from and writes checkpoints where the options
/// say so. Stages: compile (the driver's rest), firstDispatch, render, readback. Throws
/// Error{InvalidContent} for a checkpoint of another picture.
Picture renderPicture(const TraceOptions& options, const GpuScene& scene, const PictureSetup& setup,
                      StageTimer& stages);

/// As the files hold it, but for its recipes.
Image imageOf(const Picture& picture, const TraceOptions& options, const GpuScene& scene,
              const PictureSetup& setup);

void logPicture(const Picture& picture, const TraceOptions& options);

/// What the --json file says of it.
nlohmann::json figuresOf(const Picture& picture, const TraceOptions& options, const PictureSetup& setup);

} // namespace rt

#include "tools/rt-import/import_options.h"

#include "common/error.h"
#include "tools/rt-import/open_model.h"
#include "tools/rt-import/repair_mesh.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <filesystem>

namespace rt {

bool parseImportOptions(int argc, const char* const* argv, ImportOptions& options) {
    CLI::App app("Reads a model (" + readableFormats() + ") into a .rtmesh", "rt-import");
    app.add_option("MODEL", options.modelPath, "Model file; its textures are looked for in its folder")
        ->required();
    app.add_option("-o,--output", options.outputPath, "Mesh to write; - for standard output")
        ->required()
        ->type_name("FILE");
    app.add_option("--crease", options.creaseDegrees, "Angle from which generated normals keep an edge sharp")
        ->check(CLI::Range(0.0, 180.0))
        ->capture_default_str()
        ->type_name("DEG");
    addCommonOptions(app, options.common,
                     fmt::format("{}, {}, stb_image", assimpVersion(), openMeshVersion()));
    addDepfileOption(app, options.common);
    if (!parseCommandLine(app, argc, argv, options.common)) return false;

    if (options.outputPath == "-" && options.common.jsonPath == "-")
        throw Error(ErrorKind::Usage, "-o - and --json - exclude each other: both are standard output");
    if (options.outputPath == "-" && !options.common.depfilePath.empty())
        throw Error(ErrorKind::Usage, "--depfile needs an output file to speak of; -o is -");
    std::error_code ignored;
    if (std::filesystem::equivalent(options.modelPath, options.outputPath, ignored))
        throw Error(ErrorKind::Usage, fmt::format("-o {}: is the model itself", options.outputPath));
    return true;
}

} // namespace rt

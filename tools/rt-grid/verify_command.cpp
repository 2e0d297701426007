#include "tools/rt-grid/verify_command.h"

#include "common/binary_io.h"
#include "common/command_line.h"
#include "common/error.h"
#include "common/json_file.h"
#include "common/progress.h"
#include "formats/atlas_file.h"
#include "tools/rt-grid/libraries.h"
#include "tools/rt-grid/verify_atlas.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cstdio>
#include <optional>

namespace rt {
namespace {

const char* const kDescription = "Proves that rays through a .rtatlas miss nothing: all hashes match and all "
                                 "indices are in range; every triangle\n"
                                 "is listed in every voxel that it comes near; every distance and box lets "
                                 "rays leap over voxels only that are "
                                 "empty,\nor list nothing that was not tested. The proof shares no code with "
                                 "the builder. Ends with exit code 4, and "
                                 "the first\ncounter-examples, where something is wrong.";

struct VerifyOptions {
    std::string atlasPath;
    std::string meshPath; ///< empty: none
    CommonOptions common;
};

std::optional<VerifyOptions> parse(int argc, const char* const* argv) {
    VerifyOptions options;
    CLI::App app(kDescription, "rt-grid verify");
    app.add_option("atlas", options.atlasPath, "Input; - for standard input")
        ->required()
        ->type_name("scene.rtatlas");
    app.add_option(
           "--against", options.meshPath,
           "The mesh that the atlas should hold: proves that its triangles, vertices, materials, lights, "
           "cameras and images are this mesh's")
        ->type_name("scene.rtmesh");
    addCommonOptions(app, options.common, gridLibraries());
    if (!parseCommandLine(app, argc, argv, options.common)) return std::nullopt;
    if (options.atlasPath == "-" && options.meshPath == "-")
        throw Error(ErrorKind::Usage,
                    "the atlas and --against cannot both be standard input; name a file for one");
    requireDistinctPaths({options.atlasPath, options.meshPath}, {options.common.jsonPath});
    return options;
}

std::string textOf(const std::vector<Proof>& proofs) {
    std::string text;
    for (const Proof& proof : proofs) {
        text += fmt::format("{:<6}{:<11}{}\n", proof.faults.count == 0 ? "ok" : "FAULT", proof.name,
                            proof.detail);
        for (const std::string& fault : proof.faults.first) text += fmt::format("      {}\n", fault);
        if (proof.faults.count > proof.faults.first.size())
            text += fmt::format("      and {} more\n", proof.faults.count - proof.faults.first.size());
    }
    return text;
}

nlohmann::json jsonOf(const VerifyOptions& options, const AtlasFile& file, const std::vector<Proof>& proofs,
                      const StageTimer& timer) {
    nlohmann::json json;
    json["tool"] = "rt-grid verify";
    json["input"] = options.atlasPath;
    json["against"] = options.meshPath.empty() ? nlohmann::json() : nlohmann::json(options.meshPath);
    json["atlasHash"] = fmt::format("{:016x}", file.contentHash);
    json["structure"] = structureName(file.atlas.grid.dims.w);
    json["triangles"] = file.atlas.triangles.size();
    bool holds = true;
    for (const Proof& proof : proofs) {
        holds = holds && proof.faults.count == 0;
        json["proofs"].push_back({{"name", proof.name},
                                  {"detail", proof.detail},
                                  {"faults", proof.faults.count},
                                  {"first", proof.faults.first}});
    }
    json["holds"] = holds;
    for (const auto& [stage, ms] : timer.stagesMs()) json["stagesMs"][stage] = ms;
    json["totalMs"] = timer.totalMs();
    json["peakMemoryBytes"] = peakMemoryBytes();
    return json;
}

void requireAll(const std::string& name, const std::vector<Proof>& proofs) {
    std::uint64_t faults = 0;
    const std::string* first = nullptr;
    for (const Proof& proof : proofs) {
        faults += proof.faults.count;
        if (!first && proof.faults.count > 0) first = &proof.faults.first[0];
    }
    if (first)
        throw Error(ErrorKind::InvalidContent,
                    fmt::format("{}: {} fault{}, the first: {}; build it again with rt-grid", name, faults,
                                faults == 1 ? "" : "s", *first));
}

} // namespace

int verifyCommand(int argc, const char* const* argv) {
    const std::optional<VerifyOptions> options = parse(argc, argv);
    if (!options) return 0;
    const std::string& jsonPath = options->common.jsonPath;
    if (!jsonPath.empty()) requireWritable(jsonPath);
    StageTimer timer;
    std::optional<StageProgress> progress(timer);
    timer.begin("bytes");
    const AtlasFile file = readAtlas(options->atlasPath);
    std::optional<MeshFile> source;
    if (!options->meshPath.empty()) source = readMesh(options->meshPath);
    std::vector<Proof> proofs{{"bytes", fmt::format("{} bytes, hashes and indices", file.fileBytes), {}}};
    for (Proof& proof : verifyAtlas(file.atlas, source ? &*source : nullptr, timer))
        proofs.push_back(std::move(proof));
    progress.reset();
    if (!options->common.quiet && jsonPath != "-") std::fputs(textOf(proofs).c_str(), stdout);
    if (!jsonPath.empty()) writeJson(jsonPath, jsonOf(*options, file, proofs, timer));
    logStages(timer);
    requireAll(options->atlasPath, proofs);
    return 0;
}

} // namespace rt

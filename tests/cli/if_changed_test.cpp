// A chain of all tools with --if-changed: after a change exactly the steps run that have to.
#include "common/binary_io.h"
#include "formats/image.h"
#include "tests/support/read_text.h"
#include "tests/support/run_command.h"
#include "tests/support/temporary_folder.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <map>

namespace rt::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

void write(const std::string& path, const std::string& text) {
    std::ofstream(path, std::ios::binary) << text;
}

void edit(const std::string& path, const std::string& from, const std::string& to) {
    std::string text = readText(path);
    ASSERT_NE(text.find(from), text.npos) << path << ": " << from;
    for (std::size_t at = 0; (at = text.find(from, at)) != text.npos; at += to.size())
        text.replace(at, from.size(), to);
    write(path, text);
}

void damage(const std::string& path) {
    std::string bytes = readText(path);
    bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 0x10);
    write(path, bytes);
}

void writeSky(const std::string& path, float radiance) {
    Image sky;
    sky.width = 2;
    sky.height = 1;
    for (const char* name : {"B", "G", "R"})
        sky.channels.push_back({name, ImageChannel::Type::Float, {radiance, 1.0f}, {}});
    writeImage(path, sky);
}

struct Step {
    std::string name;
    std::vector<std::string> inputs, options, outputs; // -o of each that is no .json, .html or .xml
};

// The project stands in the working folder, and all names are relative.
class IfChanged : public testing::Test {
protected:
    IfChanged() {
        for (const char* tool : {"import", "grid", "trace", "compare"})
            tools_[tool] = std::string(RT_BIN_DIR "/rt-") + tool;
        fs::current_path(fs::path(folder_.file("")));
        fs::create_directory("p");
        fs::current_path("p");
        write("m.obj", "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0.5\nvt 0 0\nvt 1 0\nvt 0 1\n"
                       "usemtl a\nf 1/1 2/2 3/3\nusemtl b\nf 2/1 4/2 3/3\n");
        write("m.mtl", "newmtl a\nKd 1 1 1\nmap_Kd C:\\art\\t.ppm\nnewmtl b\nKd 1 1 1\nmap_Kd later.ppm\n");
        write("t.ppm", "P6\n1 1\n255\nabc");
        write("s.scene.json",
              R"({"models": [{"file": "m.obj"}],
                  "lights": [{"kind": "point", "position": [0.5, 0.5, 3], "intensity": 10}],
                  "cameras": [{"name": "front", "eye": [0.5, 0.5, 3], "lookAt": [0.5, 0.5, 0]}]})");
        writeSky("sky.exr", 0.5f);
    }
    ~IfChanged() override { fs::current_path(fs::path("/")); }

    CommandResult runStep(const Step& step, bool ifChanged, const std::vector<std::string>& more = {}) {
        std::vector<std::string> arguments{tools_[step.name]};
        const auto add = [&](const std::vector<std::string>& words) {
            arguments.insert(arguments.end(), words.begin(), words.end());
        };
        add(step.inputs);
        add(step.options);
        for (const std::string& output : step.outputs)
            add({output.ends_with(".json")   ? "--json"
                 : output.ends_with(".html") ? "--html"
                 : output.ends_with(".xml")  ? "--junit"
                 : output.ends_with(".vdb")  ? "--vdb"
                                             : "-o",
                 output});
        add({"--depfile", step.name + ".d"});
        if (ifChanged) add({"--if-changed"});
        add(more);
        return runCommand(arguments);
    }

    // Runs all and returns the names of those that did something.
    std::string chain(const std::vector<std::string>& more = {}) {
        std::string ran;
        for (const Step& step : steps_) {
            std::map<std::string, std::pair<std::string, fs::file_time_type>> before;
            for (const std::string& output : step.outputs)
                if (fs::exists(output)) before[output] = {readText(output), fs::last_write_time(output)};
            const CommandResult result = runStep(step, true, more);
            EXPECT_EQ(result.exitCode, 0) << step.name << ": " << result.err;
            if (result.err.find("up to date: ") == std::string::npos) {
                ran += (ran.empty() ? "" : " ") + step.name;
                continue;
            }
            EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
            EXPECT_EQ(result.out, "");
            for (const std::string& output : step.outputs) {
                EXPECT_TRUE(readText(output) == before.at(output).first) << output;
                EXPECT_TRUE(fs::last_write_time(output) == before.at(output).second) << output;
            }
        }
        return ran;
    }

    // Of a tool, with another version of the same length.
    void upgrade(const std::string& tool) {
        const std::string copy = folder_.file("rt-" + tool);
        fs::copy_file(tools_[tool], copy, fs::copy_options::overwrite_existing);
        std::string later = RT_TEST_VERSION;
        later.back() = later.back() == '9' ? '8' : '9';
        edit(copy, RT_TEST_VERSION, later);
        tools_[tool] = copy;
        EXPECT_THAT(runCommand({copy, "--version"}).out, HasSubstr(later));
    }

    void makeAll() {
        ASSERT_EQ(runStep(steps_[0], true).exitCode, 0);
        ASSERT_EQ(runStep(steps_[1], true).exitCode, 0);
        ASSERT_EQ(runStep(steps_[2], true).exitCode, 0);
        fs::copy_file("v.exr", "reference.exr");
        ASSERT_EQ(chain(), "compare");
    }

    Step& step(const std::string& name) {
        return *std::find_if(steps_.begin(), steps_.end(), [&](const Step& s) { return s.name == name; });
    }

    TemporaryFolder folder_;
    std::map<std::string, std::string> tools_;
    std::vector<Step> steps_{
        {"import", {"s.scene.json"}, {}, {"m.rtmesh", "import.json"}},
        {"grid", {"m.rtmesh"}, {"--structure", "cloud"}, {"m.rtatlas", "m.vdb", "grid.json"}},
        {"trace",
         {"m.rtatlas"},
         {"--size", "16x12", "--aov", "none", "--device", "software", "--camera", "front", "--environment",
          "sky.exr", "--reproducible"},
         {"v.exr", "v.png", "trace.json"}},
        {"compare",
         {"v.exr", "reference.exr"},
         {"--max-rmse", "*=1000", "--allow", "camera"},
         {"heat.exr", "heat.png", "page.html", "junit.xml", "compare.json"}}};
};

constexpr const char* kAll = "import grid trace compare";

struct Row {
    const char* change;
    std::function<void()> make;
    const char* runs;
};

TEST_F(IfChanged, ExactlyTheStepsRunThatHaveTo) {
    makeAll();
    const auto addOption = [&](const char* name, const char* option, const char* value) {
        step(name).options.insert(step(name).options.end(), {option, value});
    };
    const auto touchAll = [&] {
        for (const fs::directory_entry& file : fs::directory_iterator("."))
            fs::last_write_time(file.path(), fs::last_write_time(file.path()) +
                                                 std::chrono::hours(file.path().string().size() % 5 - 2));
    };
    const Row rows[] = {
        {"nothing", [] {}, ""},
        {"time stamps", touchAll, ""},
        {"a file that nobody asks for", [] { write("n.mtl", "newmtl a\n"); }, ""},
        {"a light", [] { edit("s.scene.json", "\"intensity\": 10", "\"intensity\": 12"); }, kAll},
        {"a camera", [] { edit("s.scene.json", "\"eye\": [0.5", "\"eye\": [0.6"); }, kAll},
        {"a texture", [] { write("t.ppm", "P6\n1 1\n255\nabd"); }, kAll},
        {"a texture that was missing", [] { write("later.ppm", "P6\n1 1\n255\nxyz"); }, kAll},
        {"a texture nearer to what the model says",
         [] { fs::create_directory("art"), write("art/t.ppm", "P6\n1 1\n255\nbbb"); }, kAll},
        {"a texture that has gone", [] { fs::remove("later.ppm"); }, kAll},
        {"a mesh", [] { edit("m.obj", "v 1 1 0.5", "v 1 1 0.25"); }, kAll},
        {"a material", [] { edit("m.mtl", "Kd 1 1 1", "Kd 1 1 0.5"); }, kAll},
        {"a comment in a material", [] { edit("m.mtl", "newmtl b", "# B\nnewmtl b"); }, "import"},
        {"the environment", [] { writeSky("sky.exr", 0.75f); }, "trace compare"},
        {"the reference's pixels",
         [] { fs::copy_file("v.exr", "reference.exr", fs::copy_options::overwrite_existing); }, "compare"},
        {"an option of rt-import", [&] { addOption("import", "--crease", "10"); }, kAll},
        {"one that makes the same mesh", [&] { addOption("import", "--weld", "0"); }, "import"},
        {"an option of rt-grid", [&] { addOption("grid", "--resolution", "7"); }, "grid trace compare"},
        {"an option of rt-trace", [&] { addOption("trace", "--max-depth", "2"); }, "trace"},
        {"one that is seen", [&] { addOption("trace", "--fov", "50"); }, "trace compare"},
        {"an option of rt-compare", [&] { addOption("compare", "--worst", "2"); }, "compare"},
        {"where shaders are kept", [&] { step("trace").options.push_back("--no-shader-cache"); }, ""},
        {"how much memory reading may take", [&] { addOption("import", "--max-memory", "1G"); }, ""},
        {"the order of options",
         [&] {
             auto& options = step("compare").options;
             std::rotate(options.begin(), options.begin() + 2, options.end());
         },
         ""},
        {"rt-import", [&] { upgrade("import"); }, "import"},
        {"rt-grid", [&] { upgrade("grid"); }, "grid"},
        {"rt-trace", [&] { upgrade("trace"); }, "trace compare"}, // pictures name their software
        {"rt-compare", [&] { upgrade("compare"); }, "compare"},
        {"a mesh that is gone", [] { fs::remove("m.rtmesh"); }, "import"},
        {"a report that is gone", [] { fs::remove("grid.json"); }, "grid"},
        {"a page that is gone", [] { fs::remove("page.html"); }, "compare"},
        {"a mesh that is damaged", [] { damage("m.rtmesh"); }, "import"},
        {"an atlas that is damaged", [] { damage("m.rtatlas"); }, "grid"},
        {"a volume that is damaged", [] { damage("m.vdb"); }, "grid"},
        {"a picture that is cut short", [] { fs::resize_file("v.exr", fs::file_size("v.exr") - 1); },
         "trace"},
        {"a report that is edited", [] { edit("compare.json", "pass", "fail"); }, "compare"},
        {"JUnit's report that is damaged", [] { damage("junit.xml"); }, "compare"},
        {"a map that is damaged", [] { damage("heat.png"); }, "compare"},
    };
    for (const Row& row : rows) {
        row.make();
        EXPECT_EQ(chain(), row.runs) << "changed: " << row.change;
        EXPECT_EQ(chain({"-j", "1"}), "") << "again, after: " << row.change;
        if (HasFailure()) return;
    }
}

TEST_F(IfChanged, OutputsDoNotDependOnWhereTheProjectIsNorOnThreads) {
    makeAll();
    std::map<std::string, std::string> bytes;
    for (const char* file : {"m.rtmesh", "m.rtatlas", "m.vdb", "v.exr", "v.png", "heat.exr", "page.html"})
        bytes[file] = readText(file);
    fs::create_directories(folder_.file("elsewhere/with another name"));
    fs::copy(".", folder_.file("elsewhere/with another name"), fs::copy_options::recursive);
    fs::current_path(folder_.file("elsewhere/with another name"));
    EXPECT_EQ(chain(), "");
    for (const auto& [file, content] : bytes) fs::remove(file);
    EXPECT_EQ(chain({"-j", "1"}), kAll);
    for (const auto& [file, content] : bytes) EXPECT_TRUE(readText(file) == content) << file;
    Step& import = step("import");
    import.inputs = {fs::absolute("s.scene.json").string()};
    EXPECT_EQ(chain(), "") << "nor on how the model is named";
}

TEST_F(IfChanged, OutputsThatComeOutTheSameKeepTheirTimeStamps) {
    makeAll();
    std::map<std::string, fs::file_time_type> times;
    for (const char* file :
         {"m.rtmesh", "m.rtatlas", "m.vdb", "v.exr", "v.png", "heat.exr", "heat.png", "page.html",
          "junit.xml", "compare.json", "import.d", "grid.d", "trace.d", "compare.d"}) {
        fs::last_write_time(file, fs::last_write_time(file) - std::chrono::hours(1));
        times[file] = fs::last_write_time(file);
    }
    for (const Step& each : steps_) EXPECT_EQ(runStep(each, false).exitCode, 0);
    for (const auto& [file, time] : times) EXPECT_TRUE(fs::last_write_time(file) == time) << file;
}

TEST_F(IfChanged, DependencyFilesNameAllThatIsReadAndComeBackWithoutARun) {
    makeAll();
    EXPECT_EQ(readText("import.d"), "m.rtmesh: \\\n  s.scene.json \\\n  m.mtl \\\n  m.obj \\\n  t.ppm\n");
    EXPECT_EQ(readText("grid.d"), "m.rtatlas: \\\n  m.rtmesh\n");
    EXPECT_EQ(readText("trace.d"), "v.exr: \\\n  m.rtatlas \\\n  sky.exr\n");
    EXPECT_EQ(readText("compare.d"), "heat.exr: \\\n  v.exr \\\n  reference.exr\n");
    std::map<std::string, std::string> texts;
    for (const char* file : {"import.d", "grid.d", "trace.d", "compare.d"}) {
        texts[file] = readText(file);
        fs::remove(file); // as Ninja does
    }
    EXPECT_EQ(chain(), "");
    for (const auto& [file, text] : texts) EXPECT_EQ(readText(file), text);
}

TEST_F(IfChanged, AComparisonThatFailsRunsAndFailsEveryTime) {
    makeAll();
    edit("s.scene.json", "\"intensity\": 10", "\"intensity\": 100");
    step("compare").options = {};
    for (const Step& each : steps_) EXPECT_EQ(runStep(each, true).exitCode, each.name == "compare" ? 1 : 0);
    const CommandResult again = runStep(step("compare"), true);
    EXPECT_EQ(again.exitCode, 1);
    EXPECT_THAT(again.out, HasSubstr("fail"));
    fs::copy_file("v.exr", "reference.exr", fs::copy_options::overwrite_existing);
    EXPECT_EQ(chain(), "compare");
    EXPECT_EQ(chain(), "");
    fs::copy_file("heat.exr", "reference.exr", fs::copy_options::overwrite_existing);
    EXPECT_EQ(runStep(step("compare"), true).exitCode, 1) << "what passed before does not pass now";
}

TEST_F(IfChanged, AllFramesCount) {
    steps_.pop_back();
    write("path.json", R"([{"frame": 1, "eye": [0, 0, 3], "lookAt": [0.5, 0.5, 0]},
                           {"frame": 3, "eye": [1, 0, 3], "lookAt": [0.5, 0.5, 0]}])");
    step("trace").options = {"--size",    "8x8",      "--device", "software",      "--camera-path",
                             "path.json", "--frames", "1-3",      "--reproducible"};
    step("trace").outputs = {"f.%04d.exr", "trace.json"};
    const auto trace = [&] {
        return runStep(step("trace"), true).err.find("up to date") == std::string::npos;
    };
    for (const char* name : {"import", "grid"}) ASSERT_EQ(runStep(step(name), true).exitCode, 0);
    EXPECT_TRUE(trace());
    EXPECT_EQ(readText("trace.d"), "f.0001.exr: \\\n  m.rtatlas \\\n  path.json\n");
    EXPECT_FALSE(trace());
    fs::remove("f.0002.exr");
    EXPECT_TRUE(trace());
    fs::copy_file("f.0001.exr", "f.0002.exr", fs::copy_options::overwrite_existing);
    EXPECT_TRUE(trace()) << "a frame in another's place";
    EXPECT_FALSE(trace());
    edit("path.json", "[1, 0, 3]", "[1, 0.1, 3]");
    EXPECT_TRUE(trace());
    EXPECT_FALSE(trace());
}

// Hits are bare numbers; their report says what they were made of, and which hits it is the report of.
TEST_F(IfChanged, HitsAreThoseOfTheirReport) {
    const auto writeRays = [](float x) {
        const float ray[] = {x, 0.25f, 3.0f, 0.0f, 0.0f, 0.0f, -1.0f, 1e30f};
        write("a.rays", std::string(reinterpret_cast<const char*>(ray), sizeof ray));
    };
    writeRays(0.25f);
    step("trace").options = {"--rays", "a.rays", "--device", "software"};
    step("trace").outputs = {"a.hits", "trace.json"};
    steps_.pop_back();
    EXPECT_EQ(chain(), "import grid trace");
    EXPECT_EQ(chain(), "");
    const std::string hits = readText("a.hits");
    const Row rows[] = {
        {"the rays", [&] { writeRays(0.5f); }, "trace"},
        {"hits of others", [&] { write("a.hits", hits); }, "trace"},
        {"damaged hits", [] { damage("a.hits"); }, "trace"},
        {"hits that are gone", [] { fs::remove("a.hits"); }, "trace"},
        {"a damaged report", [] { damage("trace.json"); }, "trace"},
        {"the query", [&] { step("trace").options.push_back("--any-hit"); }, "trace"},
        {"the atlas",
         [&] {
             step("grid").options.insert(step("grid").options.end(), {"--resolution", "7"});
         },
         "grid trace"},
    };
    for (const Row& row : rows) {
        row.make();
        EXPECT_EQ(chain(), row.runs) << "changed: " << row.change;
        EXPECT_EQ(chain(), "") << "again, after: " << row.change;
    }
}

TEST_F(IfChanged, WhatCannotBeLookedAtIsRefused) {
    write("rays.f32", "");
    const std::string import = tools_["import"], grid = tools_["grid"], trace = tools_["trace"],
                      compare = tools_["compare"];
    for (const std::vector<std::string>& arguments : std::vector<std::vector<std::string>>{
             {import, "m.obj", "-o", "-", "--if-changed"},
             {import, "m.obj", "-o", "m.rtmesh", "--json", "-", "--if-changed"},
             {grid, "-", "-o", "m.rtatlas", "--if-changed"},
             {grid, "m.rtmesh", "--dry-run", "--if-changed"},
             {grid, "m.rtmesh", "--dry-run", "--depfile", "d"},
             {grid, "m.rtmesh", "-o", "-", "--depfile", "d"},
             {trace, "m.rtatlas", "--rays", "rays.f32", "-o", "h", "--if-changed"},
             {trace, "m.rtatlas", "-o", "v.exr", "--explain", "--if-changed"},
             {trace, "--list-devices", "--if-changed"},
             {compare, "sky.exr", "sky.exr", "--if-changed"},
             {compare, "sky.exr", "sky.exr", "--depfile", "d"},
             {compare, "--self-test", "sky.exr", "--json", "j", "--if-changed"}}) {
        const CommandResult result = runCommand(arguments);
        EXPECT_EQ(result.exitCode, 2) << fmt::format("{}", fmt::join(arguments, " ")) << result.err;
        EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    }
}

} // namespace
} // namespace rt::test

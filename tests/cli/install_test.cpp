// What is installed works for those who have nothing else: pipelines, the formats library, pages,
// completions, packages.
#include "tests/support/read_text.h"
#include "tests/support/run_command.h"
#include "tests/support/temporary_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <set>

namespace rt::test {
namespace {

using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;

/// Needs all that the library is linked with: prints the triangles of a mesh, the PNG of a pixel up to its
/// "PNG", and the width of a Radiance HDR picture.
constexpr const char* kUsesTheFormats = R"(#include "formats/image_hdr.h"
#include "formats/image_png.h"
#include "formats/mesh_file.h"
#include <cstdio>
#include <string>
int main(int, char** argv) {
    const auto png = rt::encodePng(rt::imageOfPixels(1, 1, "BGR", [](auto...) { return 0.5F; }));
    const std::string hdr = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n" + std::string(8, 'x');
    const auto width = rt::decodeHdr(std::as_bytes(std::span(hdr)), "hdr").width;
    std::printf("%zu %.3s %u", rt::readMesh(argv[1]).mesh.triangles.size(),
                reinterpret_cast<const char*>(png.data()) + 1, width);
}
)";

class Installed : public testing::Test {
protected:
    Installed() {
        const CommandResult result = runCommand({CMAKE_PATH, "--install", RT_BUILD_DIR, "--prefix", prefix_});
        EXPECT_EQ(result.exitCode, 0) << result.err;
        write("model.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
    }

    void write(const char* name, const std::string& text) { std::ofstream(folder_.file(name)) << text; }

    CommandResult expectSuccess(const std::vector<std::string>& command) {
        CommandResult result = runCommand(command);
        EXPECT_EQ(result.exitCode, 0) << command[0] << "\n" << result.out << result.err;
        return result;
    }

    CommandResult configure() {
        return expectSuccess({CMAKE_PATH, "-G", "Ninja", "-S", folder_.file("."), "-B", folder_.file("build"),
                              "-DCMAKE_PREFIX_PATH=" + prefix_, "-DRT_DEVICES=software"});
    }
    CommandResult build() { return expectSuccess({CMAKE_PATH, "--build", folder_.file("build")}); }

    std::string importedMesh() {
        expectSuccess(
            {prefix_ + "/bin/rt-import", folder_.file("model.obj"), "-o", folder_.file("model.rtmesh")});
        return folder_.file("model.rtmesh");
    }

    TemporaryFolder folder_;
    const std::string prefix_ = folder_.file("prefix");
};

TEST_F(Installed, AProjectOutsideOfTheTreeMakesPictures) {
    write("CMakeLists.txt", "cmake_minimum_required(VERSION 3.25)\nproject(mine LANGUAGES NONE)\n"
                            "find_package(RtTools REQUIRED)\n"
                            "rt_add_scene(scene MODELS model.obj)\n"
                            "rt_add_atlas(atlas SCENE scene)\n"
                            "rt_add_render(view ATLAS atlas SIZE 16x16)\n");
    EXPECT_THAT(configure().out, HasSubstr("Build files have been written"));
    build();
    EXPECT_TRUE(std::filesystem::exists(folder_.file("build/view.exr")));
}

TEST_F(Installed, TheTurntableIsPlannedMadeAndConfigured) {
    const std::string turntable = prefix_ + "/share/rt-tools/turntable";
    const CommandResult planned = expectSuccess({prefix_ + "/bin/rt-plan", turntable + "/turntable.plan.json",
                                                 "--tools", prefix_ + "/bin", "--dry-run"});
    EXPECT_THAT(planned.out, HasSubstr("merge-around-0012"));
    std::filesystem::copy(prefix_ + "/share/rt-tools", folder_.file("."),
                          std::filesystem::copy_options::recursive);
    expectSuccess({"/usr/bin/make", "-C", folder_.file("turntable"), "RT_TOOLS_DIR=" + prefix_ + "/bin",
                   "RT_DEVICES=software", "gem.rtatlas"});
    expectSuccess({CMAKE_PATH, "-G", "Ninja", "-S", turntable, "-B", folder_.file("build"),
                   "-DCMAKE_PREFIX_PATH=" + prefix_});
    expectSuccess({CMAKE_PATH, "--build", folder_.file("build"), "--target", "gem_atlas"});
}

TEST_F(Installed, ThePipelinesArePartsThatTheirPageSaysAreInstalled) {
    const std::string folder = prefix_ + "/share/rt-tools/", page = readText(folder + "README.md");
    const std::string installed = page.substr(0, page.find("With the sources only"));
    ASSERT_NE(installed, page);
    const std::regex part("\n\\| `([^`]+)`");
    std::set<std::string> named = {"README.md", "planner"};
    for (std::sregex_iterator at(installed.begin(), installed.end(), part); at != std::sregex_iterator();
         ++at)
        named.insert(std::regex_replace((*at)[1].str(), std::regex("/$"), ""));
    std::set<std::string> there;
    for (const auto& entry : std::filesystem::directory_iterator(folder))
        there.insert(entry.path().filename());
    EXPECT_EQ(named, there);
}

TEST_F(Installed, TheFormatsLibraryIsFoundByCMake) {
    write("main.cpp", kUsesTheFormats);
    write("CMakeLists.txt", "cmake_minimum_required(VERSION 3.25)\nproject(mine LANGUAGES CXX)\n"
                            "find_package(RtTools REQUIRED COMPONENTS formats)\n"
                            "add_executable(count main.cpp)\n"
                            "target_link_libraries(count PRIVATE RtTools::rt_formats)\n");
    configure();
    build();
    EXPECT_EQ(expectSuccess({folder_.file("build/count"), importedMesh()}).out, "4 PNG 2");
}

TEST_F(Installed, TheFormatsLibraryIsFoundByPkgConfig) {
#ifdef __SANITIZE_ADDRESS__
    GTEST_SKIP() << "an instrumented library asks for the sanitizer's flags, which are no user's";
#endif
    write("main.cpp", kUsesTheFormats);
    expectSuccess({"/bin/sh", "-c",
                   "PKG_CONFIG_PATH=$(dirname $(find " + prefix_ +
                       " -name rt-formats.pc)) && export PKG_CONFIG_PATH && c++ " + folder_.file("main.cpp") +
                       " -o " + folder_.file("count") + " $(pkg-config --cflags --libs rt-formats)"});
    EXPECT_EQ(expectSuccess({folder_.file("count"), importedMesh()}).out, "4 PNG 2");
}

TEST_F(Installed, PagesSayWhatHelpSays) {
    const std::string page = readText(prefix_ + "/share/man/man1/rt-grid.1");
    for (const char* text : {"\\-\\-structure auto|uniform|cloud|octant|nested", "RT-GRID VERIFY",
                             "\\-\\-against", "EXIT CODES"})
        EXPECT_THAT(page, HasSubstr(text));
    for (const char* tool : {"rt-import", "rt-grid", "rt-trace", "rt-compare", "rt-plan"}) {
        const std::string text = readText(prefix_ + "/share/man/man1/" + tool + ".1");
        EXPECT_THAT(text, HasSubstr(".SH NAME\n"));
        EXPECT_THAT(text, Not(ContainsRegex("memory, [0-9]+M"))) << "of the machine that built it";
    }
}

TEST_F(Installed, ThePageOfThePlannerHasAllItsCommands) {
    const std::string page = readText(prefix_ + "/share/man/man1/rt-plan.1");
    for (const char* text : {"rt-plan \\- Turns a pipeline", "rt\\-plan [OPTIONS] FILE", "\\-\\-slurm DIR",
                             "RT-PLAN RUN", "\\-j,\\-\\-jobs N", "RT-PLAN STATUS", "RT-PLAN REPORT",
                             "\\-\\-junit FILE", "RT-PLAN UPDATE-GOLDENS", "RT-PLAN STEP", "EXIT CODES"})
        EXPECT_THAT(page, HasSubstr(text));
}

TEST_F(Installed, CompletionsKnowOptionsAndTheirValues) {
    const auto completed = [&](const std::string& words, const char* index) {
        const std::string tool = words.substr(0, words.find(' '));
        return expectSuccess({"/bin/bash", "-c",
                              ". " + prefix_ + "/share/bash-completion/completions/" + tool +
                                  "; COMP_WORDS=(" + words + "); COMP_CWORD=" + index + "; _" +
                                  std::regex_replace(tool, std::regex("-"), "_") + "; echo ${COMPREPLY[@]}"})
            .out;
    };
    EXPECT_EQ(completed("rt-grid --str", "1"), "--structure\n");
    EXPECT_EQ(completed("rt-grid --structure n", "2"), "nested\n");
    EXPECT_EQ(completed("rt-grid ver", "1"), "verify\n");
    EXPECT_EQ(completed("rt-grid verify --ag", "2"), "--against\n");
    EXPECT_EQ(completed("rt-plan upd", "1"), "update-goldens\n");
    EXPECT_EQ(completed("rt-plan --sl", "1"), "--slurm\n");
    EXPECT_EQ(completed("rt-plan run turn.plan.json --jo", "3"), "--jobs\n");
}

TEST_F(Installed, PackagesDependOnWhatTheyUse) {
    expectSuccess({CPACK_PATH, "--config", RT_BUILD_DIR "/CPackConfig.cmake", "-B", folder_.file("packages"),
                   "-D", "CPACK_DEBIAN_COMPRESSION_TYPE=gzip"});
    std::string tools, library;
    for (const auto& entry : std::filesystem::directory_iterator(folder_.file("packages"))) {
        const std::string name = entry.path().filename();
        if (name.starts_with("rt-tools_")) tools = entry.path();
        if (name.starts_with("librt-formats-dev_")) library = entry.path();
    }
    const std::string depends = expectSuccess({"/usr/bin/dpkg-deb", "-f", tools, "Depends"}).out;
    for (const char* package :
         {"libassimp5", "libopenvdb", "libopenexr", "libepoxy0", "libegl1", "libc6", "python3"})
        EXPECT_THAT(depends, HasSubstr(package));
    const std::string needs = expectSuccess({"/usr/bin/dpkg-deb", "-f", library, "Depends"}).out;
    for (const char* package : {"rt-tools (=", "libcli11-dev", "libopenexr-dev", "libstb-dev", "zlib1g-dev"})
        EXPECT_THAT(needs, HasSubstr(package));
    expectSuccess({"/usr/bin/dpkg-deb", "-x", tools, folder_.file("root")});
    EXPECT_THAT(expectSuccess({folder_.file("root/usr/bin/rt-grid"), "--version"}).out,
                HasSubstr("rt-grid "));
    EXPECT_THAT(expectSuccess({folder_.file("root/usr/bin/rt-plan"), "--help"}).out, HasSubstr("rt-plan"));
    for (const char* file : {"man/man1/rt-plan.1", "bash-completion/completions/rt-plan"})
        EXPECT_TRUE(std::filesystem::exists(folder_.file("root/usr/share/") + file)) << file;
}

} // namespace
} // namespace rt::test

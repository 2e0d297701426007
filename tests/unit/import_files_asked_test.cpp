// Whether another import would read the same is seen without reading the model.
#include "tests/unit/import_files.h"
#include "tools/rt-import/files_asked.h"

#include <gmock/gmock.h>

#include <filesystem>

namespace rt {
namespace {

namespace fs = std::filesystem;
using test::fourColourImage;
using testing::Each;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::UnorderedElementsAre;

class ImportFilesAsked : public testing::Test, public test::ModelFiles {
protected:
    ImportFilesAsked() {
        write("in/m.mtl", "newmtl m\nmap_Kd C:\\art\\Wood.ppm\n");
        write("in/m.obj", "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl m\nf 1/1 2/1 3/1\n");
        write("in/art/wood.ppm", fourColourImage());
        text = import("in/m.obj").filesAsked;
    }
    FilesAsked asked() const { return {{path("in/m.obj")}, {}}; }
    std::string again() const { return asked().again(text); }

    std::string text;
};

TEST_F(ImportFilesAsked, AreTheSameAsLongAsNothingChanges) {
    EXPECT_EQ(again(), text);
    EXPECT_THAT(asked().found(text), ElementsAre(path("in/art/wood.ppm"), path("in/m.mtl")));
    write("in/other.ppm", "");
    write("wood.ppm", "outside");
    EXPECT_EQ(again(), text);
    EXPECT_EQ(import("in/m.obj").filesAsked, text);
}

TEST_F(ImportFilesAsked, ChangeWithEachOfThem) {
    const auto changes = [&](const std::string& name, const std::string& content) {
        const bool wasThere = fs::exists(path(name));
        const std::string before = wasThere ? fourColourImage() : "";
        write(name, content);
        const bool changed = again() != text;
        const bool asImported = import("in/m.obj").filesAsked == again();
        if (wasThere)
            write(name, before);
        else
            fs::remove(path(name));
        EXPECT_EQ(again(), text);
        EXPECT_TRUE(asImported) << name << ": and an import sees what is seen here";
        return changed;
    };
    EXPECT_TRUE(changes("in/art/wood.ppm", fourColourImage() + "x"));
    EXPECT_TRUE(changes("in/art/Wood.ppm", fourColourImage() + "x")) << "the exact name comes first";
    EXPECT_FALSE(changes("in/wood.ppm", "x")) << "farther from what the model says";
    fs::rename(path("in/art/wood.ppm"), path("in/wood.ppm"));
    EXPECT_NE(again(), text);
}

TEST_F(ImportFilesAsked, ThoseThatAreMissingAreAwaitedInTheDeepestFolderThatIsThere) {
    EXPECT_THAT(asked().foldersOfMissing(text), ElementsAre(path("in"))) << "of C:/art/Wood.ppm there";
    fs::remove(path("in/art/wood.ppm"));
    text = import("in/m.obj").filesAsked;
    EXPECT_THAT(asked().foldersOfMissing(text), UnorderedElementsAre(path("in/art"), path("in"), path("in")));
    fs::remove(path("in/art"));
    EXPECT_THAT(asked().foldersOfMissing(text), Each(path("in")));
    const fs::path before = fs::current_path();
    fs::current_path(path("in"));
    EXPECT_THAT(FilesAsked({"m.obj"}, {}).foldersOfMissing(text), Each("."));
    fs::current_path(before);
}

TEST_F(ImportFilesAsked, DoNotDependOnHowTheModelIsNamed) {
    const fs::path before = fs::current_path();
    fs::current_path(path("in"));
    StageTimer timer;
    EXPECT_EQ(importModel("m.obj", {}, timer).filesAsked, text);
    EXPECT_EQ(importModel("../in/./m.obj", {}, timer).filesAsked, text);
    EXPECT_THAT(FilesAsked({"m.obj"}, {}).found(text), ElementsAre("art/wood.ppm", "m.mtl"));
    fs::current_path(before);
}

TEST_F(ImportFilesAsked, LinksThatLeadOutAreAsGoodAsNothing) {
    write("outside.ppm", fourColourImage()); // the same bytes
    fs::remove(path("in/art/wood.ppm"));
    fs::create_symlink(path("outside.ppm"), path("in/art/wood.ppm"));
    EXPECT_NE(again(), text);
    text = import("in/m.obj").filesAsked; // which looks farther
    EXPECT_EQ(again(), text);
}

TEST_F(ImportFilesAsked, TextsThatAreNoneAreNotBelieved) {
    const std::string id(16, 'a'), zero(1, '\0');
    EXPECT_EQ(asked().again(""), "");
    EXPECT_EQ(asked().again("short" + zero + zero + id), "");
    for (const char* name : {"7/m.mtl", "x/m.mtl", "/m.mtl", "0", "-1/m.mtl", "99999999999999999999/m.mtl",
                             "0/../../../../../../../../etc/passwd", "0/", "0//etc/passwd", "0/.", "0/art"}) {
        EXPECT_EQ(asked().again(id + name + zero), std::string(16, '-') + name + zero) << name;
        EXPECT_THAT(asked().found(std::string(16, '-') + name + zero), IsEmpty());
    }
}

} // namespace
} // namespace rt

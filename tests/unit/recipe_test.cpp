// Every output carries its recipe, and no byte of it changes unnoticed.
#include "common/command_line.h"
#include "common/error.h"
#include "formats/atlas_file.h"
#include "formats/image.h"
#include "formats/image_png.h"
#include "formats/mesh_file.h"
#include "formats/recipe.h"
#include "formats/section_file.h"
#include "tests/support/make_mesh.h"
#include "tests/support/read_text.h"
#include "tests/support/temporary_folder.h"

#include <CLI/CLI.hpp>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cstddef>
#include <cstring>
#include <fstream>
#include <sys/stat.h>

namespace rt {
namespace {

const Recipe kRecipe("0123456789abcdef");

void spill(const std::string& path, const std::string& bytes) {
    std::ofstream(path, std::ios::binary) << bytes;
}

Image smallImage(const Recipe& recipe) {
    Image image;
    image.width = 3;
    image.height = 2;
    for (const char* name : {"B", "G", "R"})
        image.channels.push_back({name, ImageChannel::Type::Float, {0, 0.25f, 0.5f, 0.75f, 1, 0.1f}, {}});
    if (recipe.isKnown()) image.texts[kRecipeKey] = recipe.mark();
    return image;
}

void writePicture(const std::string& path, const Recipe& recipe) {
    const auto bytes = sealed(encodeImage(path, smallImage(recipe)), recipe);
    spill(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

class Recipes : public testing::Test {
protected:
    std::string path(const std::string& name) const { return folder_.file(name); }

    // A file of each kind, made by the recipe.
    std::string make(const std::string& kind, const Recipe& recipe) const {
        const std::string file = path("a." + kind);
        if (kind == "json")
            writeReport(file, {{"figure", 1}}, recipe);
        else if (kind == "rtmesh")
            writeMesh(file, test::makeSphere(0), recipe);
        else if (kind == "html")
            spill(file, sealed("<html></html>\n<!-- " + recipe.mark() + " -->\n", recipe));
        else
            writePicture(file, recipe);
        return file;
    }

    test::TemporaryFolder folder_;
};

constexpr const char* kKinds[] = {"json", "html", "exr", "png", "rtmesh"};

TEST_F(Recipes, AreCarriedByTheOutputsThatTheyMade) {
    const Recipe other("0123456789abcdee");
    for (const char* kind : kKinds) {
        const std::string file = make(kind, kRecipe);
        EXPECT_TRUE(carries(file, kRecipe)) << kind;
        EXPECT_FALSE(carries(file, other)) << kind;
        EXPECT_FALSE(carries(file, Recipe())) << kind;
    }
    EXPECT_EQ(recipeIn(path("a.rtmesh")).text(), kRecipe.text());
    EXPECT_FALSE(recipeIn(path("a.json")).isKnown());
    EXPECT_FALSE(carries(path("absent"), kRecipe));
    EXPECT_FALSE(carries("/dev/null", kRecipe));
}

TEST_F(Recipes, AnyDamageIsNoticed) {
    for (const char* kind : kKinds) {
        const std::string file = make(kind, kRecipe);
        const std::string good = test::readText(file);
        for (std::size_t i = 0; i < good.size(); ++i) {
            std::string bad = good;
            bad[i] = static_cast<char>(bad[i] ^ (1 << (i % 8)));
            spill(file, bad);
            ASSERT_FALSE(carries(file, kRecipe)) << kind << ", byte " << i << " of " << good.size();
        }
        for (std::size_t length = 0; length < good.size(); length += 7) {
            spill(file, good.substr(0, length));
            ASSERT_FALSE(carries(file, kRecipe)) << kind << ", cut to " << length;
        }
        spill(file, good + ' ');
        EXPECT_FALSE(carries(file, kRecipe)) << kind << ", longer";
        spill(file, good);
        EXPECT_TRUE(carries(file, kRecipe)) << kind;
    }
}

TEST_F(Recipes, DoNotCountAsContent) {
    const Recipe other("fedcba9876543210 and more");
    for (const char* kind : kKinds) {
        const std::string file = make(kind, kRecipe);
        const auto content = contentIdOf(file);
        const std::string bytes = test::readText(file);
        ASSERT_TRUE(content) << kind;
        make(kind, other);
        EXPECT_NE(test::readText(file), bytes) << kind;
        EXPECT_EQ(contentIdOf(file), content) << kind;
    }
    const std::string mesh = make("rtmesh", kRecipe);
    const std::uint64_t hash = readMesh(mesh).contentHash;
    make("rtmesh", Recipe());
    EXPECT_EQ(readMesh(mesh).contentHash, hash) << "nor is a mesh without one another mesh";
    writeMesh(mesh, test::makeSphere(1), kRecipe);
    EXPECT_NE(readMesh(mesh).contentHash, hash);
}

TEST_F(Recipes, FilesOfEarlierVersionsKeepTheirContentHash) {
    FileKind before = kMeshKind;
    before.minor = 1;
    SectionFileWriter writer(before);
    const std::vector<std::uint32_t> values{1, 2, 3};
    writer.add<std::uint32_t>(sectionId("POSI"), values);
    writer.write(path("a"));
    const SectionFile file(path("a"), kMeshKind);
    std::uint64_t headerHash = 0;
    std::memcpy(&headerHash, test::readText(path("a")).data() + offsetof(FileHeader, headerHash), 8);
    EXPECT_EQ(file.contentHash(), headerHash);
    EXPECT_EQ(file.recipe(), "");
    writer.addRecipe("0123456789abcdef");
    writer.write(path("a"));
    EXPECT_EQ(SectionFile(path("a"), kMeshKind).contentHash(), headerHash);
    EXPECT_EQ(SectionFile(path("a"), kMeshKind).recipe(), "0123456789abcdef");
}

TEST_F(Recipes, APictureWithOneIsStillAPicture) {
    const std::string png = make("png", kRecipe);
    const std::string bytes = test::readText(png);
    EXPECT_EQ(decodePng(std::as_bytes(std::span(bytes)), png, {}).parts.at(0).image.pixelCount(), 6u);
    EXPECT_NE(bytes.find("tEXtrt:recipe"), bytes.npos);
    make("png", Recipe());
    EXPECT_EQ(test::readText(png).find("tEXt"), bytes.npos);
}

TEST_F(Recipes, AreOfContentAndRoleAndMaking) {
    spill(path("a"), "one");
    spill(path("b"), "one");
    spill(path("c"), "two");
    const auto of = [&](const std::string& making, const std::string& role, const char* file) {
        return recipeOf(making, {{role, contentIdOf(path(file))}}).text();
    };
    EXPECT_EQ(of("x", "mesh", "a"), of("x", "mesh", "b")) << "names do not count";
    EXPECT_NE(of("x", "mesh", "a"), of("x", "mesh", "c"));
    EXPECT_NE(of("x", "mesh", "a"), of("x", "scene", "a"));
    EXPECT_NE(of("x", "mesh", "a"), of("y", "mesh", "a"));
    EXPECT_EQ(of("x", "mesh", "a").size(), kRecipeIdDigits);
}

TEST_F(Recipes, AreNotKnownOfWhatCannotBeReadTwice) {
    ASSERT_EQ(mkfifo(path("pipe").c_str(), 0600), 0);
    for (const std::string& file : {std::string("-"), path("absent"), path("pipe")})
        EXPECT_FALSE(recipeOf("x", {{"mesh", contentIdOf(file)}}).isKnown()) << file;
}

std::string making(std::vector<const char*> arguments, const std::string& version = "1") {
    CLI::App app("", "tool");
    CommonOptions options;
    std::string input, size;
    std::vector<std::string> lights;
    addCommonOptions(app, options, "");
    addBuildOptions(app, options);
    app.add_option("input", input);
    app.add_option("--size", size);
    app.add_option("--light", lights)->allow_extra_args(false);
    options.version = version;
    arguments.insert(arguments.begin(), "tool");
    EXPECT_TRUE(parseCommandLine(app, static_cast<int>(arguments.size()), arguments.data(), options));
    return makingOf(app, options, {"input"});
}

TEST(Making, IsOfTheOptionsThatDecideTheOutput) {
    const std::string usual = making({"a", "--size", "8", "--light", "p", "--light", "q"});
    EXPECT_EQ(making({"b", "--light=p", "--light=q", "--size=8", "-j2", "-v", "--json", "x", "--if-changed",
                      "--depfile", "d"}),
              usual);
    EXPECT_NE(making({"a", "--size", "9", "--light", "p", "--light", "q"}), usual);
    EXPECT_NE(making({"a", "--size", "8", "--light", "q", "--light", "p"}), usual) << "lights have an order";
    EXPECT_NE(making({"a", "--size", "8", "--light", "p"}), usual);
    EXPECT_NE(making({"a", "--light", "p", "--light", "q"}), usual);
    EXPECT_NE(making({"a", "--size", "8", "--light", "p", "--light", "q"}, "2"), usual);
}

} // namespace
} // namespace rt

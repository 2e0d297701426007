// Material libraries that are wrong: what can be read is, and the rest is named with file and line.
#include "common/error.h"
#include "tests/unit/import_files.h"

#include <gmock/gmock.h>

namespace rt {
namespace {

using test::ModelFiles;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class MtlFiles : public testing::Test, public ModelFiles {
protected:
    // A triangle in each of the materials, with the library m.mtl.
    ImportedModel importWith(const std::string& library, const std::vector<std::string>& materials,
                             const ImportSettings& settings = {}) const {
        write("m.mtl", library);
        std::string obj = "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\n";
        for (const std::string& material : materials) obj += "usemtl " + material + "\nf 1 2 3\n";
        write("m.obj", obj);
        return import("m.obj", settings);
    }
};

TEST_F(MtlFiles, AMaterialThatNoLibraryDefinesIsNamed) {
    const ImportedModel model = importWith("newmtl red \nKd 1 0 0\n", {"red", "gone", "red"});
    EXPECT_THAT(model.report.warnings,
                ElementsAre("no material library defines 'gone'; what they are on is grey"));
    ASSERT_EQ(model.mesh.materials.size(), 2u);
    EXPECT_EQ(model.mesh.materials[model.mesh.triangleMaterial[0]].baseColor, glm::vec4(1, 0, 0, 1));
    ImportSettings strict;
    strict.strict = true;
    EXPECT_THROW(importWith("newmtl red\n", {"gone"}, strict), Error);
    EXPECT_THAT(importWith("newmtl red\n", {"red"}, strict).report.warnings, IsEmpty());
}

TEST_F(MtlFiles, OfManySuchMaterialsTheFirstAreNamed) {
    write("m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\nusemtl b\nf 1 3 2\nusemtl c\nf 2 1 3\n"
                   "usemtl d\nf 2 3 1\nusemtl e\nf 3 1 2\nusemtl f\nf 3 2 1\nusemtl g\nf 1 2 3\n");
    EXPECT_THAT(import("m.obj").report.warnings,
                ElementsAre(HasSubstr("'a', 'b', 'c', 'd', 'e' and 2 more of its materials")));
}

TEST_F(MtlFiles, StatementsWithoutTheirNumbersAreLeftOut) {
    const ImportedModel model =
        importWith("Kd 1 1 1\nnewmtl m\r\nKd 0.5 abc 0.1\n\tKe nan 0 0\nd\nNi 1,5\nillum x\nauthor me\n"
                   "Ks 0.5 0.5\nKs spectral x.rfl\n",
                   {"m"});
    const std::string file = path("m.mtl");
    EXPECT_THAT(
        model.report.warnings,
        ElementsAre(file + ": line 1: 'Kd 1 1 1' stands before the first material; it is left out",
                    file + ": line 3: 'Kd 0.5 abc 0.1' has not the numbers that it needs; it is left out",
                    HasSubstr("line 4: 'Ke nan 0 0'"), HasSubstr("line 5: 'd'"),
                    HasSubstr("line 6: 'Ni 1,5'"), HasSubstr("line 7: 'illum x'"),
                    HasSubstr("line 9: 'Ks 0.5 0.5'"), HasSubstr("line 10: 'Ks spectral"),
                    file + ": line 8: 'author me' is no statement that is known; it is left out"));
    EXPECT_EQ(model.mesh.materials[0].emission, glm::vec4(0));
    EXPECT_EQ(model.mesh.materials[0].transmission.x, 0.0f);
}

TEST_F(MtlFiles, WhatIsSoundStaysAsItIs) {
    const ImportedModel model = importWith("# by hand\n\nnewmtl wood and steel\n Kd .25 +0.5 1e0 # "
                                           "brown\nillum 2\nd 0.75\nNi 1.25\nsharpness x\n",
                                           {"wood and steel"});
    EXPECT_THAT(model.report.warnings, IsEmpty());
    const Material& material = model.mesh.materials[0];
    EXPECT_EQ(material.baseColor, glm::vec4(0.25, 0.5, 1, 1));
    EXPECT_EQ(material.transmission.x, 0.25f);
    EXPECT_EQ(material.transmission.y, 1.25f);
}

TEST_F(MtlFiles, AColourOfOneNumberIsGrey) {
    const ImportedModel model = importWith("newmtl m\nKd 0.5\n", {"m"});
    EXPECT_EQ(model.mesh.materials[0].baseColor, glm::vec4(0.5, 0.5, 0.5, 1));
    EXPECT_THAT(model.report.warnings, IsEmpty());
}

TEST_F(MtlFiles, AnisotropyDoesNotTakeTheModelAway) {
    const ImportedModel model =
        importWith("newmtl m\nKd 1 0 0\naniso 0.5\nanisor 0.25\nnewmtl n\naniso 0\nanisor 0.1\n", {"m", "n"});
    EXPECT_EQ(model.mesh.materials[0].baseColor, glm::vec4(1, 0, 0, 1));
    EXPECT_THAT(model.report.warnings,
                ElementsAre(path("m.mtl") + ": line 3: 'aniso 0.5' has no place in the model; it is left out",
                            HasSubstr("line 4: 'anisor 0.25' has no place")));
}

TEST_F(MtlFiles, WhatHasNoPlaceIsNamedOnceOfAKindAndCounted) {
    const std::string file = path("m.mtl");
    const std::string lost = "Ps 0.1\nPc 0.2\nPcr 0.3\nd 0.5\nTf 0.1 1 1\nNi 0.5\nrefl r.png\nmap_Ka a.png\n"
                             "map_Tr t.png\ndecal d.png\nfoo bar\n";
    const ImportedModel model = importWith("newmtl m\n" + lost + "newmtl n\n" + lost, {"m", "n"});
    const std::string end = " has no place in the model; it is left out (2 of this kind)";
    EXPECT_THAT(model.report.warnings,
                ElementsAre(file + ": line 2: 'Ps 0.1'" + end, HasSubstr("line 3: 'Pc 0.2'" + end),
                            HasSubstr("line 4: 'Pcr 0.3'" + end), HasSubstr("line 6: 'Tf 0.1 1 1'" + end),
                            HasSubstr("line 7: 'Ni 0.5' is below 1"), HasSubstr("line 8: 'refl r.png'" + end),
                            HasSubstr("line 9: 'map_Ka a.png'" + end),
                            HasSubstr("line 10: 'map_Tr t.png'" + end),
                            HasSubstr("line 11: 'decal d.png'" + end),
                            HasSubstr("line 12: 'foo bar' is no statement that is known")));
    ImportSettings strict;
    strict.strict = true;
    for (const char* statement : {"Ps 0.1", "Pc 0.2", "refl r.png", "map_Ka a.png", "decal d.png", "foo bar"})
        EXPECT_THROW(importWith(std::string("newmtl m\n") + statement + "\n", {"m"}, strict), Error)
            << statement;
}

TEST_F(MtlFiles, WhatChangesNothingIsLeftOutInSilence) {
    write("a b.ppm", test::fourColourImage());
    const ImportedModel model = importWith(
        "newmtl m\nPs 0 0 0\nPc 0\nPcr 0.3\naniso 0\nanisor 0.5\nd 0.5\nTf 1 1 1 # clear\nmap_Ka a b.ppm\n"
        "map_Kd -s 1 1 1 -o 0 0 0 -t 0 -mm 0 1 -blendu on -cc off -texres 512 -clamp off a b.ppm\n"
        "map_d -imfchan m a b.ppm\nnewmtl n\nTf 0.5 0.5 0.5\nNi 0\n",
        {"m", "n"});
    EXPECT_THAT(model.report.warnings, IsEmpty());
    EXPECT_EQ(model.mesh.images.size(), 1u);
}

TEST_F(MtlFiles, TextureOptionsThatChangeSomethingAreNamed) {
    write("a.ppm", test::fourColourImage());
    for (const std::string option : {"-s 2 2 1", "-o 0.5", "-t 0 0.1", "-mm 0 2", "-mm 0.1", "-imfchan r",
                                     "-blendv off", "-cc on", "-boost 3", "-colorspace linear"}) {
        const ImportedModel model = importWith("newmtl m\nmap_Kd -clamp on " + option + " a.ppm\n", {"m"});
        const std::string name = option.substr(0, option.find(' '));
        EXPECT_THAT(model.report.warnings, ElementsAre(path("m.mtl") + ": line 2: 'map_Kd -clamp on " +
                                                       option + " a.ppm' has an option " + name +
                                                       ", which has no place in the model and is left out"));
        EXPECT_EQ(model.mesh.images.size(), 1u) << option;
    }
}

TEST_F(MtlFiles, BlanksAndQuotesAroundTheNameOfAnImageAreNoPartOfIt) {
    write("a b.ppm", test::fourColourImage());
    for (const char* name :
         {"a b.ppm  ", "a b.ppm\t\r", "\"a b.ppm\"", "'a b.ppm' ", "-clamp on \"a b.ppm\" "}) {
        const ImportedModel model = importWith(std::string("newmtl m\nMap_Kd ") + name + "\n", {"m"});
        EXPECT_THAT(model.report.warnings, IsEmpty()) << name;
        EXPECT_EQ(model.mesh.images.size(), 1u) << name;
    }
    EXPECT_THAT(importWith("newmtl m\nmap_Kd\nKd 1 0 0\n", {"m"}).report.warnings,
                ElementsAre(HasSubstr("line 2: 'map_Kd' names no image")));
    const ImportedModel model = importWith("newmtl m\nmap_Kd -s\nKd 1 0 0\n", {"m"});
    EXPECT_THAT(model.report.warnings, ElementsAre(HasSubstr("line 2: 'map_Kd -s' names no image")));
    EXPECT_EQ(model.mesh.materials[0].baseColor, glm::vec4(1, 0, 0, 1));
}

} // namespace
} // namespace rt

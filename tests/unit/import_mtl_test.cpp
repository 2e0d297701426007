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
                    HasSubstr("line 8: 'author me'"), HasSubstr("line 9: 'Ks 0.5 0.5'"),
                    HasSubstr("line 10: 'Ks spectral")));
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

} // namespace
} // namespace rt

// FBX: the numbers of its physically based materials.
#include "tests/unit/import_files.h"

#include <gmock/gmock.h>

namespace rt {
namespace {

using test::ModelFiles;

// A triangle with one material of these properties, as text.
std::string fbx(const std::string& properties) {
    return R"(; FBX 7.4.0 project file
FBXHeaderExtension:  {
	FBXHeaderVersion: 1003
	FBXVersion: 7400
}
Objects:  {
	Geometry: 1, "Geometry::t", "Mesh" {
		Vertices: *9 {
			a: 0,0,0,1,0,0,0,1,0
		}
		PolygonVertexIndex: *3 {
			a: 0,1,-3
		}
		GeometryVersion: 124
		LayerElementMaterial: 0 {
			Version: 101
			Name: ""
			MappingInformationType: "AllSame"
			ReferenceInformationType: "IndexToDirect"
			Materials: *1 {
				a: 0
			}
		}
		Layer: 0 {
			Version: 100
			LayerElement:  {
				Type: "LayerElementMaterial"
				TypedIndex: 0
			}
		}
	}
	Model: 2, "Model::t", "Mesh" {
		Version: 232
		Properties70:  {
		}
	}
	Material: 3, "Material::m", "" {
		Version: 102
		ShadingModel: "unknown"
		MultiLayer: 0
		Properties70:  {
)" + properties +
           R"(		}
	}
}
Connections:  {
	C: "OO",2,0
	C: "OO",1,2
	C: "OO",3,2
}
)";
}

Material materialWith(const std::string& properties) {
    const ModelFiles files;
    files.write("m.fbx", fbx(properties));
    return files.import("m.fbx").mesh.materials[0];
}

TEST(ImportFbx, StingraysNumbersAreRead) {
    const Material material =
        materialWith("\t\t\tP: \"Maya|metallic\", \"float\", \"\", \"\",0.25\n"
                     "\t\t\tP: \"Maya|roughness\", \"float\", \"\", \"\",0.5\n"
                     "\t\t\tP: \"Maya|base_color\", \"Vector3D\", \"Vector\", \"\",1,0.5,0\n"
                     "\t\t\tP: \"Maya|emissive\", \"Vector3D\", \"Vector\", \"\",1,0.5,0\n"
                     "\t\t\tP: \"Maya|emissive_intensity\", \"float\", \"\", \"\",4\n");
    EXPECT_EQ(material.reflection, glm::vec4(0.25, 0.5, 1, 0));
    EXPECT_EQ(material.baseColor, glm::vec4(1, 0.5, 0, 1));
    EXPECT_EQ(material.emission, glm::vec4(4, 2, 0, 0));
    EXPECT_EQ(material.transmission.y, 1.5f);
}

TEST(ImportFbx, ThoseOf3dsMaxAreReadAsTheyStand) {
    const Material material =
        materialWith("\t\t\tP: \"3dsMax|Parameters|metalness\", \"Float\", \"\", \"A\",0.75\n"
                     "\t\t\tP: \"3dsMax|Parameters|roughness\", \"Float\", \"\", \"A\",0.25\n"
                     "\t\t\tP: \"3dsMax|Parameters|base_color\", \"ColorAndAlpha\", \"\", \"A\",0,0.5,1,1\n"
                     "\t\t\tP: \"3dsMax|Parameters|transparency\", \"Float\", \"\", \"A\",0.5\n"
                     "\t\t\tP: \"3dsMax|Parameters|trans_ior\", \"Float\", \"\", \"A\",1.25\n"
                     "\t\t\tP: \"3dsMax|Parameters|emission\", \"Float\", \"\", \"A\",2\n"
                     "\t\t\tP: \"3dsMax|Parameters|emit_color\", \"ColorAndAlpha\", \"\", \"A\",1,0.5,0,1\n");
    EXPECT_EQ(material.reflection, glm::vec4(0.75, 0.25, 1, 0));
    EXPECT_EQ(material.baseColor, glm::vec4(0, 0.5, 1, 1));
    EXPECT_EQ(material.transmission.x, 0.5f);
    EXPECT_EQ(material.transmission.y, 1.25f);
    EXPECT_EQ(material.emission, glm::vec4(2, 1, 0, 0));
}

TEST(ImportFbx, AHighlightAloneIsNoMetal) {
    const Material material = materialWith("\t\t\tP: \"ShininessExponent\", \"Number\", \"\", \"A\",25\n");
    EXPECT_EQ(material.reflection, glm::vec4(0, 1, 0, 0));
}

} // namespace
} // namespace rt

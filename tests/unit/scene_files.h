#pragma once
#include "common/error.h"
#include "tests/unit/import_files.h"

#include <gtest/gtest.h>

namespace rt::test {

inline void expectNear(const glm::dvec3& a, const glm::dvec3& b) {
    EXPECT_LT(glm::distance(a, b), 1e-6) << a.x << " " << a.y << " " << a.z;
}
inline glm::dvec3 vectorOf(const double (&v)[3]) {
    return {v[0], v[1], v[2]};
}

/// Scene files that are imported with t.obj beside them.
class SceneFiles : public testing::Test, public ModelFiles {
protected:
    // (1,0,0), (2,0,0), (1,3,0) in a material "stone"
    void SetUp() override {
        write("t.obj", "mtllib t.mtl\nv 1 0 0\nv 2 0 0\nv 1 3 0\nusemtl stone\nf 1 2 3\n");
        write("t.mtl", "newmtl stone\nKd 0.5 0.25 0.125\nillum 2\n");
    }
    ImportedModel importInputs(const std::vector<std::string>& names) const {
        SceneSources sources;
        for (const std::string& name : names) sources.inputs.push_back(path(name));
        StageTimer timer;
        return importScene(sources, {}, timer);
    }
    // Of s.scene.json.
    ImportedModel importText(const std::string& json) const {
        write("s.scene.json", json);
        return importInputs({"s.scene.json"});
    }
    std::vector<glm::vec3> positions(const std::string& json) const {
        const Mesh mesh = importText(json).mesh;
        return {mesh.positions.begin(), mesh.positions.end()};
    }
    Material material(const std::string& override) const {
        return importText(R"({"models": [{"file": "t.obj", "materials": [{"match": "stone", )" + override +
                          "}]}]}")
            .mesh.materials[0];
    }
    std::string refusal(const std::string& json, ErrorKind kind = ErrorKind::InvalidContent) const {
        try {
            importText(json);
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), kind) << error.what();
            const std::string message = error.what(), file = path("s.scene.json: ");
            return message.starts_with(file) ? message.substr(file.size()) : message;
        }
        return "nothing was refused: " + json;
    }
    std::string refusalWith(const std::string& more) const {
        return refusal(R"({"models": [{"file": "t.obj"}], )" + more + "}");
    }
};

} // namespace rt::test

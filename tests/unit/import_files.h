#pragma once
#include "common/stage_timer.h"
#include "tests/support/temporary_folder.h"
#include "tools/rt-import/import_model.h"

#include <fstream>
#include <string>
#include <vector>

namespace rt::test {

/// A folder of model files written by a test, and the import of one of them.
class ModelFiles {
public:
    void write(const std::string& name, const std::string& content) const {
        std::filesystem::create_directories(std::filesystem::path(folder_.file(name)).parent_path());
        std::ofstream(folder_.file(name), std::ios::binary) << content;
    }
    template <class T>
    void writeArray(const std::string& name, const std::vector<T>& values) const {
        write(name, std::string(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)));
    }
    std::string path(const std::string& name) const { return folder_.file(name); }
    ImportedModel import(const std::string& name, const ImportSettings& settings = {}) const {
        StageTimer timer;
        return importModel(folder_.file(name), settings, timer);
    }

private:
    TemporaryFolder folder_;
};

/// 2x2 pixels: red, green above blue, white.
inline std::string fourColourImage() {
    return std::string("P6\n2 2\n255\n\xff\0\0\0\xff\0\0\0\xff\xff\xff\xff", 23);
}

/// A TGA file of RGBA8 pixels, R lowest, top row first.
inline std::string rgbaImage(unsigned width, unsigned height, const std::vector<std::uint32_t>& pixels) {
    std::string file(18, '\0');
    file[2] = 2; // colours as they are
    file[12] = static_cast<char>(width);
    file[14] = static_cast<char>(height);
    file[16] = 32;
    file[17] = 0x28; // 8 bits of alpha, top row first
    for (const std::uint32_t p : pixels)
        for (const unsigned shift : {16u, 8u, 0u, 24u}) file.push_back(static_cast<char>(p >> shift));
    return file;
}

/// A glTF triangle (0,0,0), (1,0,0), (0,1,0) with the given normals, placed by the JSON text of `nodes`, all
/// of which are roots. Its buffer is "t.bin".
inline std::string gltfTriangle(const ModelFiles& files, const glm::vec3& normal, const std::string& nodes,
                                const std::string& material = "{}", const std::string& extra = "") {
    files.writeArray<glm::vec3>("t.bin", {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, normal, normal, normal});
    return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[)" + nodes +
           R"(],"materials":[)" + material +
           R"(],"meshes":[{"primitives":[{"attributes":{"POSITION":0,"NORMAL":1},"material":0}]}],
           "buffers":[{"uri":"t.bin","byteLength":72}],
           "bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":36}],
           "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]},
                        {"bufferView":1,"componentType":5126,"count":3,"type":"VEC3"}])" +
           extra + "}";
}

} // namespace rt::test

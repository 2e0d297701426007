#include "formats/shader_binary_file.h"

#include "formats/section_file.h"

namespace rt {
namespace {

struct ShaderBinaryInfo {
    std::uint64_t key;
    std::uint32_t format;
    std::uint32_t zero;
};
static_assert(sizeof(ShaderBinaryInfo) == 16);

constexpr FileKind kShaderKind{{'\x89', 'R', 'T', 'S', 'H', 'D', 'R', '\n'}, 1, 0, "rt-trace shader"};
constexpr std::uint32_t kInfo = sectionId("INFO");
constexpr std::uint32_t kBytes = sectionId("BYTE");

} // namespace

void writeShaderBinary(const std::string& path, const ShaderBinary& binary) {
    const ShaderBinaryInfo info{binary.key, binary.format, 0};
    SectionFileWriter writer(kShaderKind);
    writer.add(kInfo, std::span<const ShaderBinaryInfo>(&info, 1));
    writer.add(kBytes, std::span<const std::byte>(binary.bytes));
    writer.write(path);
}

ShaderBinary readShaderBinary(const std::string& path) {
    const SectionFile file(path, kShaderKind);
    file.verify([] {});
    const ShaderBinaryInfo info = file.get<ShaderBinaryInfo>(kInfo, 1)[0];
    return {info.key, info.format, file.get<std::byte>(kBytes)};
}

} // namespace rt

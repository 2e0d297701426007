#include "formats/environment_picture.h"

#include "common/binary_io.h"
#include "common/error.h"
#include "formats/image_exr.h"
#include "formats/image_hdr.h"

#include <fmt/format.h>

#include <cmath>

namespace rt {
namespace {

constexpr unsigned kColorRows = 64; // so that directions are chosen evenly over the sphere

// What is no light becomes none.
std::string cleanPixels(std::vector<glm::vec3>& pixels, const std::string& path) {
    std::size_t cleaned = 0;
    for (glm::vec3& pixel : pixels)
        for (int c = 0; c < 3; ++c) {
            if (std::isfinite(pixel[c]) && pixel[c] >= 0.0f) continue;
            pixel[c] = 0.0f;
            ++cleaned;
        }
    if (cleaned == 0) return "";
    return fmt::format("{}: {} values are negative or not finite and count as 0", path, cleaned);
}

} // namespace

bool isEnvironmentFile(const std::string& name) {
    const std::string extension = extensionOf(name);
    return extension == ".exr" || extension == ".hdr";
}

EnvironmentPicture readEnvironment(const std::string& path) {
    const Image image = extensionOf(path) == ".exr" ? readExr(path) : decodeHdr(readFile(path), path);
    const std::vector<float>& r = colorChannel(image, "R", path).values;
    const std::vector<float>& g = colorChannel(image, "G", path).values;
    const std::vector<float>& b = colorChannel(image, "B", path).values;
    EnvironmentPicture picture{image.width, image.height, {}, ""};
    picture.pixels.reserve(image.pixelCount());
    for (std::size_t i = 0; i < image.pixelCount(); ++i) picture.pixels.emplace_back(r[i], g[i], b[i]);
    picture.warning = cleanPixels(picture.pixels, path);
    return picture;
}

EnvironmentPicture evenEnvironment(const glm::vec3& radiance) {
    return {2, kColorRows, std::vector<glm::vec3>(2 * kColorRows, radiance), ""};
}

} // namespace rt

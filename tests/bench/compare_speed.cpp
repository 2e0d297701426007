// What rt-compare takes beside the reading of its files, in time and memory, of a pair of 4096x2160 pixels
// with R, G, B and A as floats (EXR, ZIP): whole processes, one kind after the other, the median of each.
//     build/release/bin/rt_compare_speed [runs [noise]]
// `noise` is the standard deviation of a pixel over its value: the less of it, the faster ZIP is read.
#include "formats/image.h"
#include "formats/parallel_check.h"
#include "formats/picture.h"
#include "tests/support/run_command.h"
#include "tests/support/split_mix.h"
#include "tests/support/temporary_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iostream>

namespace rt::test {
namespace {

constexpr std::uint32_t kWidth = 4096, kHeight = 2160;

struct Color {
    double red, green, blue, coverage;
};

// A wall of glossy balls under two lights, as a renderer leaves it before noise: soft shading, hard edges,
// highlights a hundred times as bright, black between the balls.
Color ballsAt(double x, double y) {
    constexpr double kSpacing = 240.0, kRadius = 110.0;
    const double column = std::floor(x / kSpacing), row = std::floor(y / kSpacing);
    const double dx = (x - (column + 0.5) * kSpacing) / kRadius, dy = (y - (row + 0.5) * kSpacing) / kRadius;
    const double square = dx * dx + dy * dy;
    if (square >= 1.0) return {0.0, 0.0, 0.0, 0.0};
    const double dz = std::sqrt(1.0 - square);
    const double key = std::max(0.0, -0.5 * dx - 0.6 * dy + 0.62 * dz),
                 fill = std::max(0.0, 0.8 * dx + 0.6 * dz);
    const double highlight = 100.0 * std::pow(key, 200.0);
    const double hue = 0.7 * column + 1.3 * row;
    const auto albedo = [&](double phase) { return 0.5 + 0.4 * std::sin(hue + phase); };
    const auto lit = [&](double phase) {
        return albedo(phase) * (1.5 * key + 0.2 * fill) + highlight + 0.02;
    };
    return {lit(0.0), lit(2.1), lit(4.2), 1.0};
}

// About normally distributed with mean 0 and deviation 1, for each n its own.
double noiseOf(std::uint64_t n) {
    double sum = 0.0;
    for (const std::uint64_t bits = hashOf(n); const int shift : {0, 16, 32, 48})
        sum += static_cast<double>(bits >> shift & 0xFFFFu) / 65536.0 - 0.5;
    return sum * std::sqrt(3.0);
}

// The second picture has a little more noise, of its own.
Image renderOf(double noise, bool isSecond) {
    Image image;
    image.width = kWidth;
    image.height = kHeight;
    for (const char* name : {"A", "B", "G", "R"})
        image.channels.push_back(
            {name, ImageChannel::Type::Float, std::vector<float>(image.pixelCount()), {}});
    for (std::size_t i = 0; i < image.pixelCount(); ++i) {
        const Color color = ballsAt(double(i % kWidth), double(i / kWidth));
        const double values[4] = {color.coverage, color.blue, color.green, color.red};
        for (std::size_t c = 0; c < 4; ++c) {
            double factor = c == 0 ? 1.0 : 1.0 + noise * noiseOf(4 * i + c);
            if (c > 0 && isSecond) factor *= 1.0 + 0.1 * noise * noiseOf(~(4 * i + c));
            image.channels[c].values[i] = static_cast<float>(values[c] * std::max(factor, 0.0));
        }
    }
    return image;
}

struct Kind {
    const char* what;
    std::vector<std::string> argv;
    std::vector<double> wall = {}, processor = {}, peakMemory = {};
};

double medianOf(std::vector<double> values) {
    std::ranges::sort(values);
    return values[values.size() / 2];
}

void runOnce(Kind& kind) {
    const CommandResult result = runCommand(kind.argv);
    if (result.exitCode != 0) throw std::runtime_error(kind.argv[0] + ": " + result.err + result.out);
    kind.wall.push_back(result.seconds);
    kind.processor.push_back(result.processorSeconds);
    kind.peakMemory.push_back(static_cast<double>(result.peakMemoryBytes));
}

// This program's memory counts as that of what it starts, so the pictures are made in another.
void measure(const std::string& self, int runs, const std::string& noise) {
    const TemporaryFolder folder;
    const std::string a = folder.file("a.exr"), b = folder.file("b.exr");
    const std::string tool = std::filesystem::path(self).replace_filename("rt-compare").string();
    for (const auto& [path, which] : {std::pair(a, "first"), {b, "second"}}) {
        Kind making{"make", {self, "make", path, which, noise}};
        runOnce(making);
    }
    std::vector<Kind> kinds{
        {"both files read", {self, "read", a, b}},
        {"all figures but SSIM and FLIP", {tool, a, b, "--max-rmse", "1"}},
        {"all figures but FLIP", {tool, a, b, "--max-rmse", "1", "--metrics", "ssim,ms-ssim"}},
    };
    for (int i = 0; i < runs; ++i)
        for (Kind& kind : kinds) runOnce(kind);
    const double pairBytes = 2.0 * 4.0 * sizeof(float) * kWidth * kHeight;
    fmt::print("| {} runs, median | wall | processor | against reading | peak memory / pair "
               "|\n|---|---|---|---|---|\n",
               runs);
    for (const Kind& kind : kinds)
        fmt::print("| {} | {:.0f} ms | {:.0f} ms | {:.2f} ({:.2f} of processor time) | {:.2f} |\n", kind.what,
                   1e3 * medianOf(kind.wall), 1e3 * medianOf(kind.processor),
                   medianOf(kind.wall) / medianOf(kinds[0].wall),
                   medianOf(kind.processor) / medianOf(kinds[0].processor),
                   medianOf(kind.peakMemory) / pairBytes);
}

void run(const std::vector<std::string>& arguments) {
    const std::string command = arguments.size() > 1 ? arguments[1] : "";
    if (command == "make") {
        writeImage(arguments.at(2), renderOf(std::stod(arguments.at(4)), arguments.at(3) == "second"));
    } else if (command == "read") {
        Picture a, b; // as rt-compare reads them: together
        checkTogether(
            {[&] { a = readPicture(arguments.at(2), {}); }, [&] { b = readPicture(arguments.at(3), {}); }});
    } else {
        const int runs = arguments.size() > 1 ? std::stoi(arguments[1]) : 7;
        measure(arguments[0], std::max(runs, 1), arguments.size() > 2 ? arguments[2] : "0.08");
    }
}

} // namespace
} // namespace rt::test

int main(int argc, char** argv) {
    try {
        rt::test::run({argv, argv + argc});
        return 0;
    } catch (const std::exception& error) {
        std::cerr << argv[0] << ": error: " << error.what() << '\n';
        return 1;
    }
}

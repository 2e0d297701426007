#include "tests/support/compared_layers.h"
#include "tests/support/run_command.h"
#include "tests/support/split_mix.h"
#include "tests/support/temporary_folder.h"
#include "tools/rt-compare/compare.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <fstream>

namespace rt::test {
namespace {

constexpr int kWidth = 211, kHeight = 97;

// Values of all magnitudes around 1, a third of them equal in both files.
void writePair(const std::string& pathA, const std::string& pathB) {
    std::ofstream a(pathA, std::ios::binary), b(pathB, std::ios::binary);
    for (std::ofstream* file : {&a, &b}) *file << "PF\n" << kWidth << " " << kHeight << "\n-1.0\n";
    RayNumbers numbers(1, 2);
    for (int i = 0; i < kWidth * kHeight * 3; ++i) {
        const float value = numbers.between(-0.1f, 1.5f);
        const float error = std::pow(10.0f, numbers.between(-5.0f, 0.5f)) * numbers.between(-1.0f, 1.0f);
        const float other = numbers.unit() < 0.33f ? value : value + error;
        a.write(reinterpret_cast<const char*>(&value), sizeof value);
        b.write(reinterpret_cast<const char*>(&other), sizeof other);
    }
}

void expectNear(double found, const nlohmann::json& wanted, const std::string& what) {
    EXPECT_NEAR(found, wanted.get<double>(), 1e-12 + 1e-10 * std::abs(wanted.get<double>())) << what;
}

void expectSame(const ErrorFigures& f, const nlohmann::json& numpy) {
    expectNear(f.maxAbs, numpy.at("maxAbs"), "maxAbs");
    expectNear(f.bias, numpy.at("bias"), "bias");
    expectNear(f.mae, numpy.at("mae"), "mae");
    expectNear(f.mse, numpy.at("mse"), "mse");
    expectNear(f.rmse, numpy.at("rmse"), "rmse");
    expectNear(f.relMse, numpy.at("relMse"), "relMse");
    expectNear(f.smape, numpy.at("smape"), "smape");
    expectNear(f.psnr, numpy.at("psnr"), "psnr");
    expectNear(f.a.mean, numpy.at("meanA"), "meanA");
    expectNear(f.b.min, numpy.at("minB"), "minB");
    for (std::size_t i = 0; i < 4; ++i) {
        const double percentile = numpy.at("percentiles").at(i).get<double>();
        EXPECT_NEAR(f.percentiles.at(i).absError, percentile, 1e-7 * percentile) << i; // single precision
        EXPECT_EQ(f.over.at(i).pixels, numpy.at("over").at(i).get<std::uint64_t>()) << i;
    }
}

TEST(CompareNumpy, FiguresAreThoseOfNumpy) {
    const TemporaryFolder folder;
    const std::string a = folder.file("a.pfm"), b = folder.file("b.pfm");
    writePair(a, b);
    const CommandResult result =
        runCommand({PYTHON_PATH, RT_SOURCE_DIR "/tests/cli/compare_figures.py", a, b});
    ASSERT_EQ(result.exitCode, 0) << result.err;
    const auto numpy = nlohmann::json::parse(result.out);
    const Comparison comparison = comparePictures(readPicture(a, {}), readPicture(b, {}), {}).comparison;
    ASSERT_NE(colorOf(comparison), nullptr);
    expectSame(colorOf(comparison)->figures, numpy.at("all"));
    for (const ChannelComparison& channel : colorOf(comparison)->channels)
        expectSame(channel.figures, numpy.at(channel.name));
}

} // namespace
} // namespace rt::test

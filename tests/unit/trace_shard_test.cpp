// Which device is meant, which part of a picture a shard has, and what its samples add up to.
#include "common/error.h"
#include "tools/rt-trace/device_choice.h"
#include "tools/rt-trace/sample_sum.h"
#include "tools/rt-trace/shard.h"
#include "tools/rt-trace/tile_samples.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

namespace rt {
namespace {

using Kind = DeviceRequest::Kind;

ErrorKind kindOf(const std::function<void()>& body, std::string& message) {
    try {
        body();
    } catch (const Error& error) {
        message = error.what();
        return error.kind();
    }
    ADD_FAILURE() << "no error";
    return ErrorKind::Internal;
}

TEST(DeviceChoice, TextsAreParsed) {
    EXPECT_EQ(parseDevice("auto", "--device").kind, Kind::Auto);
    EXPECT_EQ(parseDevice("software", "--device").kind, Kind::Software);
    EXPECT_EQ(parseDevice("12", "--device").number, 12u);
    const DeviceRequest cuda = parseDevice("cuda:3", "RT_DEVICE");
    EXPECT_EQ(cuda.kind, Kind::Cuda);
    EXPECT_EQ(cuda.number, 3u);
    EXPECT_EQ(cuda.text, "RT_DEVICE=cuda:3");
    std::string message;
    for (const char* const bad :
         {"", "gpu", "-1", "1x", "10000", "cuda:", "cuda:x", "cuda:-1", "cuda", "1,2"}) {
        EXPECT_EQ(kindOf([&] { parseDevice(bad, "RT_DEVICE"); }, message), ErrorKind::Usage) << bad;
        EXPECT_THAT(message, testing::StartsWith("RT_DEVICE: '" + std::string(bad) + "'"));
    }
}

TEST(DeviceChoice, CudaNumbersComeFromTheAttribute) {
    std::int32_t asked = 0;
    const auto answer = [&](std::optional<std::intptr_t> number) {
        return [&asked, number](std::int32_t attribute) {
            asked = attribute;
            return number;
        };
    };
    EXPECT_EQ(cudaNumber("EGL_EXT_device_drm EGL_NV_device_cuda", answer(1)), 1u);
    EXPECT_EQ(asked, 0x323A);
    EXPECT_EQ(cudaNumber("EGL_NV_device_cuda", answer(std::nullopt)), std::nullopt) << "hidden from CUDA";
    EXPECT_EQ(cudaNumber("EGL_NV_device_cuda", answer(-1)), std::nullopt);
    asked = 0;
    EXPECT_EQ(cudaNumber("EGL_NV_device_cuda2", answer(1)), std::nullopt);
    EXPECT_EQ(cudaNumber(nullptr, answer(1)), std::nullopt);
    EXPECT_EQ(asked, 0);
}

TEST(DeviceChoice, CudaNumbersDecideWhichGpuComesFirst) {
    using testing::ElementsAre;
    // CUDA_VISIBLE_DEVICES=2,1 on a host with three GPUs and a software renderer.
    const std::vector<ListedDevice> devices = {{true, {}}, {false, {}}, {false, 1u}, {false, 0u}};
    EXPECT_THAT(devicesToTry(devices, false), ElementsAre(3, 2, 1));
    EXPECT_THAT(devicesToTry(devices, true), ElementsAre(0, 1, 2, 3));
    EXPECT_EQ(findDevice(parseDevice("cuda:0", "--device"), devices), 3u);
    EXPECT_EQ(findDevice(parseDevice("cuda:1", "--device"), devices), 2u);
    EXPECT_EQ(findDevice(parseDevice("1", "--device"), devices), 1u) << "indices are the list's";
    std::string message;
    EXPECT_EQ(kindOf([&] { findDevice(parseDevice("cuda:2", "--device"), devices); }, message),
              ErrorKind::NoGpu);
    EXPECT_THAT(message,
                testing::HasSubstr("--device cuda:2: no device has this CUDA number: there are cuda:1, "
                                   "cuda:0;"));
    EXPECT_EQ(kindOf([&] { findDevice(parseDevice("4", "--device"), devices); }, message), ErrorKind::NoGpu);
}

TEST(Shard, PartsCoverTheWindowInWholeTiles) {
    for (const glm::uvec4 window :
         {glm::uvec4(0, 0, 7, 1), {3, 31, 9, 33}, {0, 0, 9, 1080}, {5, 40, 6, 1000}}) {
        const unsigned most = mostShards(ShardKind::Parts, window, 1);
        EXPECT_EQ(most, TileSamples(glm::uvec4(0, window.y, 1, window.w), 1).tiles().size());
        for (unsigned count = 1; count <= most; ++count) {
            unsigned y = window.y;
            for (unsigned i = 1; i <= count; ++i) {
                const glm::uvec4 part = windowOf({i, count, ShardKind::Parts}, window);
                ASSERT_EQ(part, glm::uvec4(window.x, y, window.z, part.w));
                ASSERT_GT(part.w, y) << "none is empty";
                ASSERT_TRUE(part.w % TileSamples::kSide == 0 || i == count);
                y = part.w;
            }
            ASSERT_EQ(y, window.w);
        }
    }
}

TEST(Shard, SampleRangesFollowEachOther) {
    for (const unsigned samples : {1u, 7u, 64u, 1u << 24})
        for (const unsigned count : {1u, 3u, 7u}) {
            if (count > mostShards(ShardKind::Samples, {0, 0, 1, 1}, samples)) continue;
            unsigned next = 0;
            for (unsigned i = 1; i <= count; ++i) {
                const SampleRange range = samplesOf({i, count, ShardKind::Samples}, samples);
                ASSERT_EQ(range.first, next);
                ASSERT_GE(range.count, samples / count);
                next += range.count;
            }
            ASSERT_EQ(next, samples);
        }
}

// A grey pixel with the samples 1, 3 | 5 | 2, 2, 8: mean 3.5, squares of distances 33.5, over 6 * 5.
TEST(SampleSum, MeansAndVariancesAreThoseOfAllSamples) {
    const auto rangeOf = [](float mean, float variance, std::uint32_t id) {
        Image image;
        image.width = image.height = 1;
        for (const char* const name : {"B", "G", "R"})
            image.channels.push_back({name, ImageChannel::Type::Float, {mean}, {}});
        image.channels.push_back({"Z", ImageChannel::Type::Float, {float(id)}, {}});
        image.channels.push_back({"id", ImageChannel::Type::Uint, {}, {id}});
        image.channels.push_back({"variance", ImageChannel::Type::Float, {variance}, {}});
        return image;
    };
    SampleSum sum;
    sum.add(rangeOf(2.0f, 1.0f, 9), 2); // (1 + 1) / (2 * 1)
    sum.add(rangeOf(5.0f, 0.0f, 0), 1);
    sum.add(rangeOf(4.0f, 4.0f, 0), 3); // (4 + 4 + 16) / (3 * 2)
    const Image all = sum.result();
    EXPECT_EQ(all.find("G")->values[0], 3.5f);
    EXPECT_NEAR(all.find("variance")->values[0], 33.5 / 30.0, 1e-6);
    EXPECT_EQ(all.find("Z")->values[0], 9.0f) << "the first sample's";
    EXPECT_EQ(all.find("id")->uints[0], 9u);
}

} // namespace
} // namespace rt

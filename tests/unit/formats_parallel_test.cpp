// Checks of large files run on several threads: what they report does not depend on how many.
#include "common/error.h"
#include "formats/atlas_file.h"
#include "formats/parallel_check.h"
#include "tests/support/read_text.h"
#include "tests/support/temporary_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <atomic>
#include <chrono>
#include <fstream>
#include <functional>
#include <thread>

namespace rt {
namespace {

using testing::EndsWith;
using testing::HasSubstr;

constexpr std::uint32_t kSide = 128; // 2^21 voxels: many blocks of any check

std::string messageOf(const std::function<void()>& doing) {
    try {
        doing();
    } catch (const Error& error) {
        return error.what();
    }
    return "no error";
}

void withThreads(std::size_t threads, const std::function<void()>& doing) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    SCOPED_TRACE(std::to_string(threads) + " threads");
    doing();
}

// All voxels are empty but the first, which lists the only triangle.
Atlas largeAtlas(const std::function<void(std::vector<std::uint32_t>& voxels)>& change) {
    Atlas atlas;
    atlas.grid.cellSize = atlas.grid.cellsPerUnit = glm::vec4(1, 1, 1, 0);
    atlas.grid.worldOffset = glm::vec4(0, 0, 0, 1);
    atlas.grid.dims = glm::uvec4(kSide, kSide, kSide, kStructureNested);
    atlas.grid.counts = glm::uvec4(1, 3, 1, 0);
    std::vector<std::uint32_t> voxels(std::size_t(kSide) * kSide * kSide, 0u);
    voxels[0] = leafWord(0);
    change(voxels);
    atlas.voxels = std::move(voxels);
    atlas.references = std::vector<std::uint32_t>{0, kLastInList};
    atlas.triangles = std::vector<TriangleRecord>{{{0, 0, 0, 0}, {1, 0, 0, 0}, {0, 1, 0, 0}}};
    atlas.triangleVertices = std::vector<glm::uvec4>{{0, 1, 2, 0}};
    atlas.normals = std::vector<std::uint32_t>(3, 0u);
    atlas.materials = std::vector<Material>{diffuseMaterial(glm::vec3(1.0f))};
    return atlas;
}

TEST(FirstFault, IsTheLowestEvenIfItIsFoundLast) {
    for (const std::size_t threads : {1u, 2u}) {
        withThreads(threads, [] {
            const auto firstIn = [](std::size_t begin, std::size_t end) {
                if (begin == 0) std::this_thread::sleep_for(std::chrono::milliseconds(20));
                for (std::size_t i = begin; i < end; ++i)
                    if (i % 1000 == 7) return i;
                return end;
            };
            EXPECT_EQ(firstFault(100000, 10, firstIn), 7u);
            EXPECT_EQ(firstFault(1007, 1000, firstIn), 7u);
            EXPECT_EQ(firstFault(8, 1000, firstIn), 7u);
            EXPECT_EQ(firstFault(7, 1000, firstIn), 7u) << "none is at fault";
            EXPECT_EQ(firstFault(0, 1000, firstIn), 0u);
        });
    }
}

TEST(CheckTogether, ReportsTheFirstInOrderAndRunsAll) {
    for (const std::size_t threads : {1u, 2u}) {
        withThreads(threads, [] {
            std::atomic<int> ran = 0;
            const auto fails = [&](const char* what, int waitMs) {
                return [&ran, what, waitMs] {
                    std::this_thread::sleep_for(std::chrono::milliseconds(waitMs));
                    ++ran;
                    throw Error(ErrorKind::InvalidContent, what);
                };
            };
            const std::string message = messageOf([&] {
                checkTogether({[&] { ++ran; }, fails("slow", 20), fails("quick", 0), [&] { ++ran; }});
            });
            EXPECT_EQ(message, "slow");
            EXPECT_EQ(ran, 4);
        });
    }
}

TEST(WhileChecking, WorksOnThisThreadAndReturnsWhatTheWorkDoes) {
    const std::thread::id here = std::this_thread::get_id();
    std::thread::id checker, worker;
    const auto result = whileChecking([&] { checker = std::this_thread::get_id(); }, 0,
                                      [&] {
                                          worker = std::this_thread::get_id();
                                          return std::make_unique<int>(7);
                                      });
    EXPECT_EQ(*result, 7);
    EXPECT_EQ(worker, here);
    EXPECT_NE(checker, here);
}

TEST(WhileChecking, OneThreadDoesOneAfterTheOther) {
    std::thread::id checker;
    bool worked = false;
    whileChecking(
        [&] {
            checker = std::this_thread::get_id();
            EXPECT_TRUE(worked);
        },
        1, [&] { worked = true; });
    EXPECT_EQ(checker, std::this_thread::get_id());
}

TEST(WhileChecking, WhatTheCheckThrowsComesFirstHoweverLate) {
    std::atomic<int> ran = 0;
    const auto passes = [&] { ++ran; };
    const auto fails = [&](const char* what, int waitMs) {
        return [&ran, what, waitMs] {
            std::this_thread::sleep_for(std::chrono::milliseconds(waitMs));
            ++ran;
            throw Error(ErrorKind::InvalidContent, what);
        };
    };
    EXPECT_EQ(messageOf([&] { whileChecking(fails("check", 20), 0, fails("work", 0)); }), "check");
    EXPECT_EQ(messageOf([&] { whileChecking(fails("check", 0), 0, fails("work", 20)); }), "check");
    EXPECT_EQ(messageOf([&] { whileChecking(fails("check", 0), 0, passes); }), "check");
    EXPECT_EQ(messageOf([&] { whileChecking(passes, 0, fails("work", 0)); }), "work");
    EXPECT_EQ(ran, 8);
}

TEST(LargeAtlas, TheLowestInvalidIndexIsReported) {
    const test::TemporaryFolder folder;
    const std::string path = folder.file("a.rtatlas");
    writeAtlas(path, largeAtlas([](std::vector<std::uint32_t>& voxels) {
                   for (std::size_t i = 123456; i < voxels.size(); i += 1000) voxels[i] = 1u << 30;
               }));
    for (const std::size_t threads : {1u, 2u})
        withThreads(threads, [&] {
            EXPECT_EQ(messageOf([&] { readAtlas(path); }), path + ": voxel 123456 is invalid");
        });
}

TEST(LargeAtlas, TheLastVoxelIsChecked) {
    Atlas atlas = largeAtlas([](std::vector<std::uint32_t>& voxels) { voxels.back() = leafWord(1); });
    EXPECT_EQ(messageOf([&] { validate(atlas, "a"); }), "a: voxel 2097151 is invalid");
    atlas = largeAtlas([](std::vector<std::uint32_t>&) {});
    EXPECT_NO_THROW(validate(atlas, "a"));
}

TEST(LargeAtlas, ADamagedLastWordIsReportedAsDamageWhateverItMeans) {
    const test::TemporaryFolder folder;
    const std::string path = folder.file("a.rtatlas");
    writeAtlas(path, largeAtlas([](std::vector<std::uint32_t>& voxels) { voxels.back() = 0x12345678u; }));
    std::string content = test::readText(path);
    const std::size_t last = content.find("\x78\x56\x34\x12");
    ASSERT_NE(last, std::string::npos);
    for (const char damage : {'\x01', '\x40'}) { // a box of another size; no kind of word
        content[last + 3] = static_cast<char>(0x12 ^ damage);
        std::ofstream(path, std::ios::binary | std::ios::trunc) << content;
        for (const std::size_t threads : {1u, 2u})
            withThreads(threads, [&] {
                EXPECT_THAT(messageOf([&] { readAtlas(path); }),
                            EndsWith("section VOXL is damaged (wrong checksum)"));
            });
    }
}

TEST(LargeAtlas, MisplacedBricksAreReportedByTheirNumberInTheFile) {
    constexpr std::uint32_t kWordsOfFirst = 64;
    const auto messageFor = [&](std::uint32_t third) {
        Atlas atlas = largeAtlas([&](std::vector<std::uint32_t>& voxels) {
            voxels[1000] = brickWord(0, 2); // it holds another one
            voxels[2000000] = third;
        });
        std::vector<std::uint32_t> bricks(kWordsOfFirst + 16, 0u);
        bricks[kWordsOfFirst - 1] = brickWord(kWordsOfFirst, 1);
        atlas.bricks = std::move(bricks);
        const std::string message = messageOf([&] { validate(atlas, "a"); });
        EXPECT_EQ(message, messageOf([&] { bricksOf(atlas, "a"); }));
        return message;
    };
    EXPECT_EQ(messageFor(brickWord(kWordsOfFirst + 8, 1)), "no error");
    EXPECT_EQ(messageFor(brickWord(kWordsOfFirst, 1)),
              "a: brick 2: it is not where the bricks before it end");
    EXPECT_THAT(messageFor(0), HasSubstr("brick 2: its section is longer than the bricks in use"));
}

} // namespace
} // namespace rt

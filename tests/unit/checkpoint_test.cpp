#include "common/binary_io.h"
#include "common/error.h"
#include "formats/checkpoint_file.h"
#include "tests/support/read_text.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

namespace rt {
namespace {

Checkpoint sampleCheckpoint() {
    Checkpoint checkpoint;
    checkpoint.info = {1, {2, 5}, {64, 32}, {0, 0, 2, 1}, 16, 7, 12.5};
    checkpoint.tiles = {{3, 16}};
    checkpoint.planes = {{0, {1, 2, 3, 4, 5, 6, 7, 8}}, {2, {9, 10}}};
    return checkpoint;
}

TEST(Checkpoint, ComesBackAsItWas) {
    const test::TemporaryFolder folder;
    writeCheckpoint(folder.file("c"), sampleCheckpoint());
    const Checkpoint read = readCheckpoint(folder.file("c"));
    EXPECT_EQ(read.info.settings[1], 5u);
    EXPECT_EQ(read.info.window[2], 2u);
    EXPECT_EQ(read.info.samples, 16u);
    EXPECT_EQ(read.info.gpuMs, 12.5);
    ASSERT_EQ(read.tiles.size(), 1u);
    EXPECT_EQ(read.tiles[0].samples, 3u);
    ASSERT_EQ(read.planes.size(), 2u);
    EXPECT_EQ(read.planes[1].image, 2u);
    EXPECT_EQ(read.planes[0].words, sampleCheckpoint().planes[0].words);
}

// Every file that is cut short or has one bit changed.
TEST(Checkpoint, DamageIsInvalidContent) {
    const test::TemporaryFolder folder;
    writeCheckpoint(folder.file("c"), sampleCheckpoint());
    const std::string bytes = test::readText(folder.file("c"));
    const auto expectInvalid = [&](const std::string& damaged, std::size_t at) {
        writeFile(folder.file("d"), damaged);
        try {
            readCheckpoint(folder.file("d"));
            ADD_FAILURE() << "was read, damaged at " << at;
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::InvalidContent) << at;
        }
    };
    for (std::size_t i = 0; i < bytes.size(); ++i) {
        expectInvalid(bytes.substr(0, i), i);
        std::string damaged = bytes;
        damaged[i] = static_cast<char>(damaged[i] ^ 16);
        expectInvalid(damaged, i);
    }
}

} // namespace
} // namespace rt

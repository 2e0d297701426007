// The container of .rtmesh and .rtatlas files.
#include "formats/atlas_file.h"
#include "formats/mesh_file.h"
#include "formats/section_file.h"
#include "tests/support/read_text.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/format_files.h"

#include <gtest/gtest.h>

#include <csignal>
#include <cstddef>
#include <cstring>
#include <fstream>
#include <sys/stat.h>
#include <thread>

namespace rt::test {
namespace {

TEST(SectionFile, UnknownSectionsAreSkippedAndOtherMajorVersionsRefused) {
    const TemporaryFolder folder;
    const std::string path = folder.file("x");
    constexpr FileKind kind{{'\x89', 'T', 'E', 'S', 'T', ' ', ' ', '\n'}, 1, 5, ".test"};
    const std::vector<std::uint32_t> values{1, 2, 3};
    SectionFileWriter writer(kind);
    writer.add<std::uint32_t>(sectionId("NEWX"), values);
    writer.add<std::uint32_t>(sectionId("KNWN"), values);
    writer.write(path);
    FileKind reader = kind;
    reader.minor = 0;
    const SectionFile file(path, reader);
    EXPECT_EQ(file.get<std::uint32_t>(sectionId("KNWN"), 3)[2], 3u);
    EXPECT_TRUE(file.get<std::uint32_t>(sectionId("NONE")).empty());
    EXPECT_EQ(failureOf([&] { file.get<std::uint64_t>(sectionId("KNWN")); }), ErrorKind::InvalidContent);
    reader.major = 2;
    EXPECT_EQ(failureOf([&] { SectionFile(path, reader); }), ErrorKind::InvalidContent);
}

// A pipe into which a file's bytes go, and then as many zeros as the reader takes.
class EndlessPipe {
public:
    EndlessPipe(const std::string& path, const std::string& start) {
        EXPECT_EQ(mkfifo(path.c_str(), 0600), 0);
        writer_ = std::thread([path, start] {
            std::ofstream pipe(path, std::ios::binary);
            pipe << start;
            const std::string zeros(1u << 16, '\0');
            while (pipe << zeros) {
            }
        });
    }
    ~EndlessPipe() { writer_.join(); }

private:
    std::thread writer_;
};

TEST(SectionFile, StreamsWithoutAnEndAreRefusedWithoutReadingThem) {
    std::signal(SIGPIPE, SIG_IGN);
    const TemporaryFolder folder;
    EXPECT_EQ(failureOf([&] { readMesh("/dev/zero"); }), ErrorKind::InvalidContent);
    EXPECT_EQ(failureOf([&] { readAtlas("/dev/zero"); }), ErrorKind::InvalidContent);
    writeMesh(folder.file("a"), smallMesh());
    std::string whole = readText(folder.file("a"));
    {
        const EndlessPipe pipe(folder.file("longer"), whole);
        EXPECT_EQ(failureOf([&] { readMesh(folder.file("longer")); }), ErrorKind::InvalidContent);
    }
    const std::uint64_t huge = std::uint64_t(1) << 60;
    std::memcpy(whole.data() + offsetof(FileHeader, fileBytes), &huge, sizeof huge);
    const EndlessPipe pipe(folder.file("huge"), whole);
    EXPECT_EQ(failureOf([&] { readMesh(folder.file("huge")); }), ErrorKind::LimitExceeded);
}

} // namespace
} // namespace rt::test

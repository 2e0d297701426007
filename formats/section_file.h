#pragma once
#include "common/binary_io.h"
#include "common/error.h"

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace rt {

/// Four characters that name a section.
constexpr std::uint32_t sectionId(const char (&name)[5]) {
    std::uint32_t id = 0;
    for (int i = 3; i >= 0; --i) id = (id << 8) | static_cast<unsigned char>(name[i]);
    return id;
}

/// What distinguishes one container format from another.
struct FileKind {
    std::array<char, 8> magic;
    std::uint16_t major;
    std::uint16_t minor;
    const char* name; ///< ".rtmesh", for messages
};

// The container of .rtmesh and .rtatlas; every byte is described in formats/README.md.
struct FileHeader {
    std::array<char, 8> magic;
    std::uint16_t major;
    std::uint16_t minor;
    std::uint32_t sectionCount;
    std::uint64_t fileBytes;
    std::uint64_t tableOffset;
    std::uint64_t headerHash; ///< XXH3 of the header with this field 0, followed by the table
    std::uint64_t reserved[3];
};
static_assert(sizeof(FileHeader) == 64);

struct SectionEntry {
    std::uint32_t id;
    std::uint32_t elementBytes;
    std::uint64_t offset; ///< from the start of the file, a multiple of 64
    std::uint64_t bytes;
    std::uint64_t hash; ///< XXH3 of the section's bytes
};
static_assert(sizeof(SectionEntry) == 32);

inline constexpr FileKind kMeshKind{{'\x89', 'R', 'T', 'M', 'E', 'S', 'H', '\n'}, 2, 2, ".rtmesh"};
inline constexpr FileKind kAtlasKind{{'\x89', 'R', 'T', 'A', 'T', 'L', 'S', '\n'}, 3, 2, ".rtatlas"};

/// The text of a Recipe: the last section, which is no part of the content.
inline constexpr std::uint32_t kRecipeSection = sectionId("RECP");

inline constexpr std::uint64_t kSectionAlignment = 64;
inline constexpr std::uint32_t kMaxSections = 256;

/// Collects sections (it keeps the spans, not copies) and writes them whole or not at all.
class SectionFileWriter {
public:
    explicit SectionFileWriter(const FileKind& kind) : kind_(kind) {}

    template <class T>
    void add(std::uint32_t id, std::span<const T> values) {
        static_assert(std::is_trivially_copyable_v<T>);
        addBytes(id, sizeof(T), std::as_bytes(values));
    }
    /// Last of all; nothing is added if it is empty.
    void addRecipe(std::string_view text) {
        if (!text.empty()) add<char>(kRecipeSection, text);
    }
    /// `beside`: files that are to appear with it or not at all. Throws Error{FileAccess}.
    void write(const std::string& path, std::vector<OutputFile> beside = {}) const;

private:
    struct Section {
        std::uint32_t id;
        std::uint32_t elementBytes;
        std::span<const std::byte> bytes;
    };
    void addBytes(std::uint32_t id, std::uint32_t elementBytes, std::span<const std::byte> bytes);

    FileKind kind_;
    std::vector<Section> sections_;
};

/// Opens a container and validates its frame: magic, version, table, bounds, alignment, padding. After that
/// the spans it hands out are safe to read; verify() tells whether to believe them.
class SectionFile {
public:
    /// Of a stream no more is read than its header says. Throws Error{FileAccess}, Error{InvalidContent}, or
    /// Error{LimitExceeded} if a stream does not fit into memory; messages name the file, by `shownAs` if
    /// that is given.
    SectionFile(const std::string& path, const FileKind& kind, const std::string& shownAs = "");
    /// Of a file that was read already, which messages call `name`.
    SectionFile(SharedSpan<std::byte> bytes, const FileKind& kind, const std::string& name = "");

    /// The section's elements; empty if it is absent. Throws Error{InvalidContent} if its element size is not
    /// T's.
    template <class T>
    SharedSpan<T> get(std::uint32_t id) const {
        static_assert(std::is_trivially_copyable_v<T> && alignof(T) <= kSectionAlignment);
        const std::span<const std::byte> bytes = getBytes(id, sizeof(T));
        return {std::span(reinterpret_cast<const T*>(bytes.data()), bytes.size() / sizeof(T)), storage_};
    }

    /// As get(), and throws Error{InvalidContent} unless there are exactly `count` elements.
    template <class T>
    SharedSpan<T> get(std::uint32_t id, std::uint64_t count) const {
        SharedSpan<T> values = get<T>(id);
        requireCount(id, values.size(), count);
        return values;
    }

    /// Checks every section's hash and, at the same time, what the sections mean: `checkContents` throws if
    /// that is wrong. Throws Error{InvalidContent} if a hash is, whatever `checkContents` finds in damaged
    /// bytes.
    void verify(const std::function<void()>& checkContents) const;

    /// Whether every section's hash is right. Starts no threads.
    bool isWhole() const;

    /// Hash of everything in the file but its recipe: changes whenever any byte of any other section does.
    std::uint64_t contentHash() const { return contentHash_; }
    /// Empty if the file has none.
    std::string recipe() const;
    std::uint64_t fileBytes() const { return storage_->size(); }
    [[noreturn]] void fail(const std::string& what) const;

private:
    const SectionEntry* find(std::uint32_t id) const;
    std::span<const std::byte> getBytes(std::uint32_t id, std::uint32_t elementBytes) const;
    void requireCount(std::uint32_t id, std::uint64_t found, std::uint64_t wanted) const;
    void readHeader(const FileKind& kind);
    void checkSections() const;
    void checkHashes() const;

    std::string path_;
    std::shared_ptr<const SharedSpan<std::byte>> storage_;
    std::vector<SectionEntry> table_;
    std::uint64_t contentHash_ = 0;
};

} // namespace rt

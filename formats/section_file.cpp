#include "formats/section_file.h"

#include "formats/parallel_check.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <cstring>

namespace rt {
namespace {

std::uint64_t aligned(std::uint64_t offset) {
    return (offset + kSectionAlignment - 1) / kSectionAlignment * kSectionAlignment;
}

std::uint64_t hashBytes(std::span<const std::byte> bytes) {
    return XXH3_64bits(bytes.data(), bytes.size());
}

std::uint64_t hashHeader(FileHeader header, std::span<const SectionEntry> table) {
    header.headerHash = 0;
    std::vector<std::byte> bytes(sizeof(header) + table.size_bytes());
    std::memcpy(bytes.data(), &header, sizeof(header));
    if (!table.empty()) std::memcpy(bytes.data() + sizeof(header), table.data(), table.size_bytes());
    return hashBytes(bytes);
}

std::string idText(std::uint32_t id) {
    std::string text;
    for (int i = 0; i < 4; ++i) {
        const char c = static_cast<char>((id >> (8 * i)) & 0xff);
        text += c >= 0x20 && c < 0x7f ? c : '?';
    }
    return text;
}

struct Layout {
    FileHeader header;
    std::vector<SectionEntry> table;
};

// Gives each section its place, in this order, and the header its hash.
Layout layOut(FileHeader header, std::vector<SectionEntry> table) {
    std::uint64_t offset = aligned(sizeof(FileHeader) + table.size() * sizeof(SectionEntry));
    for (SectionEntry& entry : table) {
        entry.offset = offset;
        offset = aligned(offset + entry.bytes);
    }
    header.sectionCount = static_cast<std::uint32_t>(table.size());
    header.fileBytes = offset;
    header.headerHash = hashHeader(header, table);
    return {header, std::move(table)};
}

// The header's hash in a file without the recipe.
std::uint64_t hashOfContent(const FileHeader& header, std::vector<SectionEntry> table) {
    std::erase_if(table, [](const SectionEntry& entry) { return entry.id == kRecipeSection; });
    return layOut(header, std::move(table)).header.headerHash;
}

[[noreturn]] void throwInvalid(const std::string& name, const std::string& what) {
    throw Error(ErrorKind::InvalidContent, name + ": " + what);
}

FileHeader headerOf(std::span<const std::byte> bytes, const FileKind& kind, const std::string& name) {
    FileHeader header{};
    if (bytes.size() < sizeof(header))
        throwInvalid(name, fmt::format("{} bytes are too few for a {} file", bytes.size(), kind.name));
    std::memcpy(&header, bytes.data(), sizeof(header));
    if (header.magic != kind.magic)
        throwInvalid(name, fmt::format("is not a {} file (its first 8 bytes differ)", kind.name));
    if (header.major != kind.major)
        throwInvalid(
            name,
            fmt::format("{} version {}.{} cannot be read by this tool, which reads {}.x; make the file again",
                        kind.name, header.major, header.minor, kind.major));
    return header;
}

// An endless stream is refused by its first bytes, or where the file should have ended.
SharedSpan<std::byte> readContainer(const std::string& path, const FileKind& kind, const std::string& name) {
    const auto lengthOf = [&](std::span<const std::byte> head) {
        return headerOf(head, kind, name).fileBytes;
    };
    return readFile(path, {sizeof(FileHeader), lengthOf, {}});
}

bool allZero(std::span<const std::byte> bytes) {
    return std::all_of(bytes.begin(), bytes.end(), [](std::byte b) { return b == std::byte{0}; });
}

} // namespace

void SectionFileWriter::addBytes(std::uint32_t id, std::uint32_t elementBytes,
                                 std::span<const std::byte> bytes) {
    sections_.push_back({id, elementBytes, bytes});
}

void SectionFileWriter::write(const std::string& path, std::vector<OutputFile> beside) const {
    FileHeader header{};
    header.magic = kind_.magic;
    header.major = kind_.major;
    header.minor = kind_.minor;
    header.tableOffset = sizeof(FileHeader);
    std::vector<SectionEntry> sections;
    for (const Section& section : sections_)
        sections.push_back(
            {section.id, section.elementBytes, 0, section.bytes.size(), hashBytes(section.bytes)});
    const Layout layout = layOut(header, std::move(sections));

    static constexpr std::byte kZeros[kSectionAlignment]{};
    const std::uint64_t tableEnd = sizeof(FileHeader) + layout.table.size() * sizeof(SectionEntry);
    std::vector<std::span<const std::byte>> chunks{std::as_bytes(std::span(&layout.header, 1)),
                                                   std::as_bytes(std::span(layout.table)),
                                                   std::span(kZeros, aligned(tableEnd) - tableEnd)};
    for (const Section& section : sections_) {
        chunks.push_back(section.bytes);
        chunks.push_back(std::span(kZeros, aligned(section.bytes.size()) - section.bytes.size()));
    }
    beside.insert(beside.begin(), {path, std::move(chunks)});
    writeFiles(beside);
}

SectionFile::SectionFile(const std::string& path, const FileKind& kind, const std::string& shownAs)
    : SectionFile(readContainer(path, kind, shownAs.empty() ? path : shownAs), kind,
                  shownAs.empty() ? path : shownAs) {}

SectionFile::SectionFile(SharedSpan<std::byte> bytes, const FileKind& kind, const std::string& name)
    : path_(name), storage_(std::make_shared<const SharedSpan<std::byte>>(std::move(bytes))) {
    readHeader(kind);
    checkSections();
    contentHash_ = hashOfContent(headerOf(*storage_, kind, path_), table_);
}

void SectionFile::fail(const std::string& what) const {
    throwInvalid(path_, what);
}

void SectionFile::readHeader(const FileKind& kind) {
    const SharedSpan<std::byte>& bytes = *storage_;
    const FileHeader header = headerOf(bytes, kind, path_);
    if (header.fileBytes < bytes.size())
        fail(fmt::format("is longer than the {} bytes that its header says; it was added to",
                         header.fileBytes));
    if (header.fileBytes > bytes.size())
        fail(fmt::format("is {} bytes long, but its header says {}; it was cut short", bytes.size(),
                         header.fileBytes));
    if (header.sectionCount > kMaxSections || header.tableOffset != sizeof(header) ||
        sizeof(header) + header.sectionCount * sizeof(SectionEntry) > bytes.size())
        fail(fmt::format("its section table ({} entries at byte {}) does not fit", header.sectionCount,
                         header.tableOffset));
    table_.resize(header.sectionCount);
    if (!table_.empty())
        std::memcpy(table_.data(), bytes.data() + sizeof(header), table_.size() * sizeof(SectionEntry));
    if (hashHeader(header, table_) != header.headerHash) fail("its header is damaged (wrong checksum)");
}

void SectionFile::checkSections() const {
    const std::span<const std::byte> bytes = *storage_;
    std::uint64_t end = sizeof(FileHeader) + table_.size() * sizeof(SectionEntry);
    for (const SectionEntry& entry : table_) {
        const std::string name = idText(entry.id);
        if (entry.offset != aligned(end) || entry.offset > bytes.size() ||
            entry.bytes > bytes.size() - entry.offset)
            fail(fmt::format("section {} ({} bytes at {}) lies outside the file or out of order", name,
                             entry.bytes, entry.offset));
        if (entry.elementBytes == 0 || entry.bytes % entry.elementBytes != 0)
            fail(fmt::format("section {}: {} bytes are no whole number of {}-byte elements", name,
                             entry.bytes, entry.elementBytes));
        if (find(entry.id) != &entry) fail(fmt::format("section {} appears twice", name));
        if (!allZero(bytes.subspan(end, entry.offset - end)))
            fail(fmt::format("bytes before section {} are not zero", name));
        end = entry.offset + entry.bytes;
    }
    if (aligned(end) != bytes.size() || !allZero(bytes.subspan(end))) fail("bytes after the last section");
}

void SectionFile::checkHashes() const {
    const std::size_t damaged = firstFault(table_.size(), 1, [&](std::size_t i, std::size_t) {
        const SectionEntry& entry = table_[i];
        return hashBytes(storage_->subspan(entry.offset, entry.bytes)) == entry.hash ? i + 1 : i;
    });
    if (damaged < table_.size())
        fail(fmt::format("section {} is damaged (wrong checksum)", idText(table_[damaged].id)));
}

void SectionFile::verify(const std::function<void()>& checkContents) const {
    checkTogether({[this] { checkHashes(); }, checkContents});
}

bool SectionFile::isWhole() const {
    return std::all_of(table_.begin(), table_.end(), [&](const SectionEntry& entry) {
        return hashBytes(storage_->subspan(entry.offset, entry.bytes)) == entry.hash;
    });
}

const SectionEntry* SectionFile::find(std::uint32_t id) const {
    const auto found =
        std::find_if(table_.begin(), table_.end(), [id](const SectionEntry& e) { return e.id == id; });
    return found == table_.end() ? nullptr : &*found;
}

std::span<const std::byte> SectionFile::getBytes(std::uint32_t id, std::uint32_t elementBytes) const {
    const SectionEntry* entry = find(id);
    if (!entry) return {};
    if (entry->elementBytes != elementBytes)
        fail(fmt::format("section {} has {}-byte elements; {} expected", idText(id), entry->elementBytes,
                         elementBytes));
    return std::span<const std::byte>(*storage_).subspan(entry->offset, entry->bytes);
}

std::string SectionFile::recipe() const {
    const SectionEntry* const entry = find(kRecipeSection);
    if (!entry || entry->elementBytes != 1) return {};
    return std::string(reinterpret_cast<const char*>(storage_->data()) + entry->offset, entry->bytes);
}

void SectionFile::requireCount(std::uint32_t id, std::uint64_t found, std::uint64_t wanted) const {
    if (found != wanted)
        fail(fmt::format("section {} has {} elements; {} expected", idText(id), found, wanted));
}

} // namespace rt

#include "formats/recipe.h"

#include "common/binary_io.h"
#include "common/error.h"
#include "common/json_file.h"
#include "formats/image_png.h"
#include "formats/section_file.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <sys/stat.h>
#include <xxhash.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstring>
#include <memory>

namespace rt {
namespace {

using Bytes = std::span<const std::byte>;

constexpr std::string_view kMarkStart = "rt-recipe:";
constexpr std::size_t kSealDigits = 16;
constexpr std::size_t kMarkBytes = kMarkStart.size() + kRecipeIdDigits + 1 + kSealDigits;

std::string hexOf(std::uint64_t value) {
    return fmt::format("{:016x}", value);
}

std::string_view textOf(Bytes bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::string idOf(const Recipe& recipe) {
    return hexOf(XXH3_64bits(recipe.text().data(), recipe.text().size()));
}

// Where the mark of this recipe begins, its seal left open; of any recipe, if `id` is empty.
std::size_t findMark(std::string_view text, const std::string& id) {
    const std::string start = std::string(kMarkStart) + id;
    for (std::size_t at = text.find(start); at != text.npos; at = text.find(start, at + 1)) {
        const std::string_view mark = text.substr(at, kMarkBytes);
        if (mark.size() < kMarkBytes || mark[kMarkStart.size() + kRecipeIdDigits] != ':') continue;
        if (std::all_of(mark.begin() + kMarkStart.size(), mark.end(),
                        [](unsigned char c) { return c == ':' || std::isxdigit(c); }))
            return at;
    }
    return text.npos;
}

// Of the chunk of a PNG that ends with the mark; CRC-32, highest byte first.
std::array<std::byte, kPngCrcBytes> crcOfChunk(Bytes png, std::size_t mark) {
    const std::size_t before = pngTextHead(kRecipeKey).size();
    return mark < before ? std::array<std::byte, kPngCrcBytes>{}
                         : pngCrc(png.subspan(mark - before, before + kMarkBytes));
}

// XXH3 of the bytes but for [first, first + count) and, of a PNG, the checksum of the mark's chunk behind it.
std::uint64_t hashWithout(Bytes bytes, std::size_t first, std::size_t count) {
    const std::size_t skipped = count + (isPng(bytes) ? kPngCrcBytes : 0);
    const Bytes rest = bytes.subspan(std::min(bytes.size(), first + skipped));
    const std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> state(XXH3_createState(), &XXH3_freeState);
    if (!state) throw std::bad_alloc();
    XXH3_64bits_reset(state.get());
    XXH3_64bits_update(state.get(), bytes.data(), first);
    XXH3_64bits_update(state.get(), rest.data(), rest.size());
    return XXH3_64bits_digest(state.get());
}

std::size_t sealOf(std::size_t mark) {
    return mark + kMarkBytes - kSealDigits;
}

bool hasGoodSeal(Bytes bytes, std::size_t mark) {
    return textOf(bytes).substr(sealOf(mark), kSealDigits) ==
           hexOf(hashWithout(bytes, sealOf(mark), kSealDigits));
}

void seal(std::span<std::byte> bytes, const Recipe& recipe) {
    if (!recipe.isKnown()) return;
    const std::size_t mark = findMark(textOf(bytes), idOf(recipe));
    if (mark == std::string_view::npos) throw Error(ErrorKind::Internal, "an output lacks its recipe");
    const std::string digits = hexOf(hashWithout(bytes, sealOf(mark), kSealDigits));
    std::memcpy(bytes.data() + sealOf(mark), digits.data(), digits.size());
    if (isPng(bytes)) std::ranges::copy(crcOfChunk(bytes, mark), bytes.data() + mark + kMarkBytes);
}

// Nothing for what is no regular file: a stream could be read once only.
std::optional<SharedSpan<std::byte>> bytesOfFile(const std::string& path) {
    struct stat info {};
    if (stat(path.c_str(), &info) != 0 || !S_ISREG(info.st_mode)) return std::nullopt;
    try {
        return readFile(path);
    } catch (const Error&) {
        return std::nullopt;
    }
}

// Nothing for what is no container, or one that is not even valid as far as its table. The bytes have to
// outlive it.
std::optional<SectionFile> containerIn(Bytes bytes) try {
    for (const FileKind* kind : {&kMeshKind, &kAtlasKind})
        if (textOf(bytes).starts_with({kind->magic.data(), kind->magic.size()}))
            return SectionFile(SharedSpan<std::byte>(bytes, nullptr), *kind);
    return std::nullopt;
} catch (const Error&) {
    return std::nullopt;
}

} // namespace

std::string Recipe::mark() const {
    return isKnown() ? std::string(kMarkStart) + idOf(*this) + ':' + std::string(kSealDigits, '0') : "";
}

std::string contentIdOf(std::span<const std::byte> file) {
    if (const auto container = containerIn(file)) return hexOf(container->contentHash());
    const std::size_t mark = findMark(textOf(file), "");
    const bool has = mark != std::string_view::npos;
    return hexOf(has ? hashWithout(file, mark, kMarkBytes) : XXH3_64bits(file.data(), file.size()));
}

std::optional<std::string> contentIdOf(const std::string& path) {
    const auto bytes = bytesOfFile(path);
    return bytes ? std::optional(contentIdOf(*bytes)) : std::nullopt;
}

Recipe recipeOf(const std::string& making, const std::vector<RecipeInput>& inputs) {
    std::string all = making;
    for (const RecipeInput& input : inputs) {
        if (!input.contentId) return {};
        all += '\n' + input.role + '\0' + *input.contentId;
    }
    return Recipe(hexOf(XXH3_64bits(all.data(), all.size())));
}

std::vector<std::byte> sealed(std::vector<std::byte> bytes, const Recipe& recipe) {
    seal(bytes, recipe);
    return bytes;
}

std::string sealed(std::string bytes, const Recipe& recipe) {
    seal(std::as_writable_bytes(std::span(bytes)), recipe);
    return bytes;
}

Recipe recipeIn(const std::string& path) {
    const auto bytes = bytesOfFile(path);
    const auto container = bytes ? containerIn(*bytes) : std::nullopt;
    return container ? Recipe(container->recipe()) : Recipe();
}

std::string reportText(nlohmann::json report, const Recipe& recipe) {
    if (recipe.isKnown()) report["recipe"] = recipe.mark();
    return sealed(jsonText(report), recipe);
}

void writeReport(const std::string& path, nlohmann::json report, const Recipe& recipe) {
    writeFile(path, reportText(std::move(report), recipe));
}

bool carries(const std::string& path, const Recipe& recipe) {
    const auto bytes = bytesOfFile(path);
    if (!bytes || !recipe.isKnown()) return false;
    if (const auto container = containerIn(*bytes))
        return container->recipe() == recipe.text() && container->isWhole();
    const std::string_view text = textOf(*bytes);
    const std::size_t mark = findMark(text, idOf(recipe));
    if (mark == text.npos) return false;
    const bool isWhole = hasGoodSeal(*bytes, mark);
    return isWhole && (!isPng(*bytes) || std::ranges::equal(bytes->subspan(mark + kMarkBytes, kPngCrcBytes),
                                                            crcOfChunk(*bytes, mark)));
}

bool isSealBroken(std::span<const std::byte> bytes) {
    const std::size_t mark = findMark(textOf(bytes), "");
    return mark != std::string_view::npos && !hasGoodSeal(bytes, mark);
}

} // namespace rt

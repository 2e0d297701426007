#include "tools/rt-import/mend_mtl.h"

#include "tools/rt-import/mtl_statement.h"

#include <assimp/material.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>

namespace rt {
namespace {

template <std::size_t N>
bool isOneOf(std::string_view word, const std::array<std::string_view, N>& list) {
    return std::find(list.begin(), list.end(), word) != list.end();
}

std::string lower(std::string_view word) {
    std::string result(word);
    for (char& c : result) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return result;
}

constexpr std::array<std::string_view, 9> kColors{"Ka", "Kd", "Ks", "Ke", "ka", "kd", "ks", "ke", "Tf"};
constexpr std::array<std::string_view, 9> kNumbers{"illum", "Tr", "d", "Ns", "Ni", "ns", "ni", "Pr", "Pm"};

// Empty for a statement of one of those that makes no sense.
std::string mended(std::string_view line) {
    const std::vector<std::string_view> words = wordsOf(line);
    const auto numbers = static_cast<std::size_t>(std::find_if_not(words.begin() + 1, words.end(), numberOf) -
                                                  words.begin() - 1);
    if (isOneOf(words[0], kNumbers) && numbers >= 1) return std::string(line);
    if (!isOneOf(words[0], kColors) || numbers < 1) return "";
    if (numbers >= 3) return std::string(line);
    const bool isAll = words.size() == numbers + 1 || words[numbers + 1].starts_with('#');
    return numbers == 1 && isAll ? fmt::format("{0} {1} {1} {1}", words[0], words[1]) : "";
}

class Mender {
public:
    Mender(const std::string& path, std::set<std::string>& names, std::vector<std::string>& warnings)
        : path_(path), names_(names), warnings_(warnings) {}

    // What Assimp shall read in place of a line.
    std::string mend(std::string_view raw) {
        ++number_;
        line_ = trimmed(raw);
        std::string_view rest = line_;
        const std::string_view key = takeWord(rest);
        if (key.empty() || key.starts_with('#')) return "";
        if (key == "newmtl") {
            endMaterial();
            hasMaterial_ = true;
            names_.insert(rest.empty() ? AI_DEFAULT_MATERIAL_NAME : std::string(rest));
            return std::string(raw);
        }
        if (isOneOf(key, kColors) || isOneOf(key, kNumbers)) return mendNumbers(key);
        if (isOneOf(lower(key), kTextures)) return mendTexture(lower(key), rest);
        drop(key, rest);
        return "";
    }

    void finish() {
        endMaterial();
        for (const Loss& loss : losses_)
            warnings_.push_back(
                loss.count == 1 ? loss.first : fmt::format("{} ({} of this kind)", loss.first, loss.count));
    }

private:
    static constexpr std::array<std::string_view, 15> kTextures{
        "map_kd", "map_ks", "map_ns", "map_d",    "map_ke", "map_emissive", "map_bump", "bump",
        "map_kn", "norm",   "disp",   "map_disp", "map_pr", "map_pm",       "map_ps"};

    // What else a material says decides whether a statement changes anything.
    struct Facts {
        bool always = true, transmits = false, refracts = false, coated = false, brushed = false;
        bool ambientDiffers = false;
        std::string baseName;
    };
    struct Doubt {
        bool Facts::*matters;
        std::string kind, warning;
    };
    struct Loss {
        std::string kind, first;
        std::size_t count;
    };

    std::string warning(std::string_view what) const {
        constexpr std::size_t kMostShown = 60;
        return fmt::format("{}: line {}: '{}' {}", path_, number_, line_.substr(0, kMostShown), what);
    }
    void doubt(bool Facts::*matters, std::string_view kind, std::string_view what) {
        doubts_.push_back({matters, std::string(kind), warning(what)});
    }

    std::string mendNumbers(std::string_view key) {
        const std::string statement = hasMaterial_ ? mended(line_) : "";
        if (statement.empty()) {
            warnings_.push_back(warning(hasMaterial_ ? "has not the numbers that it needs; it is left out"
                                                     : "stands before the first material; it is left out"));
            return "";
        }
        const double value = *numberOf(wordsOf(line_)[1]);
        facts_.transmits |= (key == "d" && value < 1.0) || (key == "Tr" && value > 0.0);
        facts_.refracts |= facts_.transmits || key == "Pr" || key == "Pm" ||
                           (key == "illum" && (value == 5.0 || value == 7.0));
        if (key == "Tf" && !isAll(statement, 1.0))
            doubt(&Facts::transmits, key, "has no place in the model; it is left out");
        if (lower(key) == "ni" && value < 1.0)
            doubt(&Facts::refracts, key, "is below 1, the least index; it is left out");
        return statement;
    }

    std::string mendTexture(const std::string& key, std::string_view rest) {
        if (!hasMaterial_) {
            warnings_.push_back(warning("stands before the first material; it is left out"));
            return "";
        }
        const TextureStatement texture = parseTexture(rest);
        for (const std::string_view option : texture.lost) {
            if (key == "map_d" && option == "-imfchan" && rest.find("-imfchan m ") != rest.npos) continue;
            doubt(&Facts::always, fmt::format("{} {}", key, option),
                  fmt::format("has an option {}, which has no place in the model and is left out", option));
        }
        if (texture.name.empty()) {
            doubt(&Facts::always, key, "names no image; it is left out");
            return "";
        }
        if (key == "map_kd") facts_.baseName = texture.name;
        return fmt::format("{} {}{}", key, texture.kept, texture.name);
    }

    // A statement that has no place in the model, if it changes anything.
    void drop(std::string_view key, std::string_view rest) {
        constexpr std::array<std::string_view, 2> kMeaningless{"sharpness", "map_aat"}; // nothing reflects it
        constexpr std::array<std::string_view, 5> kUnusual{"Ps", "Pc", "Pcr", "aniso", "anisor"};
        constexpr std::array<std::string_view, 4> kNoPlace{"refl", "decal", "map_tr", "map_opacity"};
        const std::string name = lower(key);
        if (isOneOf(key, kMeaningless) || (isOneOf(key, kUnusual) && isAll(line_, 0.0))) return;
        bool Facts::*matters = &Facts::always;
        if (key == "Pc") facts_.coated = true;
        if (key == "aniso") facts_.brushed = true;
        if (key == "Pcr") matters = &Facts::coated;
        if (key == "anisor") matters = &Facts::brushed;
        if (name == "map_ka") {
            matters = &Facts::ambientDiffers;
            ambientName_ = parseTexture(rest).name;
        }
        const bool known = isOneOf(key, kUnusual) || isOneOf(name, kNoPlace) || name == "map_ka";
        doubt(matters, key,
              known ? "has no place in the model; it is left out"
                    : "is no statement that is known; it is left out");
    }

    void endMaterial() {
        facts_.ambientDiffers = ambientName_ != facts_.baseName;
        for (Doubt& doubted : doubts_) {
            if (!(facts_.*doubted.matters)) continue;
            const auto known = std::find_if(losses_.begin(), losses_.end(),
                                            [&](const Loss& loss) { return loss.kind == doubted.kind; });
            if (known == losses_.end())
                losses_.push_back({std::move(doubted.kind), std::move(doubted.warning), 1});
            else
                ++known->count;
        }
        doubts_.clear();
        ambientName_.clear();
        facts_ = {};
    }

    const std::string& path_;
    std::set<std::string>& names_;
    std::vector<std::string>& warnings_;
    std::size_t number_ = 0;
    std::string_view line_;
    bool hasMaterial_ = false;
    Facts facts_;
    std::string ambientName_;
    std::vector<Doubt> doubts_;
    std::vector<Loss> losses_;
};

} // namespace

std::string mendMtl(std::string_view text, const std::string& path, std::set<std::string>& names,
                    std::vector<std::string>& warnings) {
    Mender mender(path, names, warnings);
    std::string result;
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t end = std::min(text.find('\n', at), text.size());
        result += mender.mend(text.substr(at, end - at)) + '\n';
        at = end + 1;
    }
    mender.finish();
    return result;
}

} // namespace rt

#pragma once
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace rt {

/// The text of a material library (.mtl), of which Assimp refuses the whole model for a word that is not the
/// number it should be, takes a colour of one number for a red, and what it knows nothing of for something
/// else. Colours of one number become grey, names of images lose blanks and quotes around them, and
/// statements and options of textures are blanked whose numbers are missing, none or infinite, that stand
/// before the first material or have no place in ours. Each of those that changes something adds a warning
/// with `path`, line and statement; of those without a place the first of a kind, with their count. `names`
/// gets those of the materials.
std::string mendMtl(std::string_view text, const std::string& path, std::set<std::string>& names,
                    std::vector<std::string>& warnings);

} // namespace rt

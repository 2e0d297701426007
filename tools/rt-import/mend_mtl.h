#pragma once
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace rt {

/// The text of a material library (.mtl), of which Assimp refuses the whole model for a word that is not the
/// number it should be, and takes a colour of one number for a red. Colours of one number become grey;
/// statements whose numbers are missing, none or infinite, that stand before the first material, or that
/// Assimp would take for others are blanked and add a warning with `path` and line. `names` gets those of the
/// materials.
std::string mendMtl(std::string_view text, const std::string& path, std::set<std::string>& names,
                    std::vector<std::string>& warnings);

} // namespace rt

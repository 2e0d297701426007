#pragma once
#include <string>

namespace rt {

/// A text as it may stand in an element or an attribute of HTML and XML. Control characters, for which XML
/// has no place, not even escaped, become spaces.
std::string escapedMarkup(const std::string& text);

} // namespace rt

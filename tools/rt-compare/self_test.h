#pragma once
#include "tools/rt-compare/options.h"

#include <optional>
#include <string>
#include <vector>

namespace rt {

/// A fault put into a layer of a picture, and what the comparison with the sound picture said.
struct Injection {
    std::string layer, fault;
    bool applies = true;                 ///< else it changes nothing that is compared, or is allowed
    std::optional<FindingKind> expected; ///< what must be found; nothing: the error is below the limits
    bool asExpected = false;
    std::string found; ///< what was said
};

/// Puts one fault after the other into each layer of the picture and compares it, with the limits of
/// `options`, where the mask (nullptr: none) lets it be seen. What an error of the values must lead to is
/// computed apart, by plain loops. Throws Error{InvalidContent} if the picture does not even pass against
/// itself.
std::vector<Injection> injectFaults(const Picture& picture, const CompareOptions& options,
                                    const Picture* mask = nullptr);

/// injectFaults() of a file, printed. Returns 0 if all went as expected; else throws Error{Internal}.
int runSelfTest(const Options& options);

} // namespace rt

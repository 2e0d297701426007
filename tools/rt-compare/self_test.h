#pragma once
#include "tools/rt-compare/options.h"

#include <string>
#include <vector>

namespace rt {

/// A fault put into a picture, and what the comparison with the sound picture said.
struct Injection {
    std::string fault;
    bool applies = true; ///< else it changes nothing in this picture
    std::string
        expected; ///< kind of the finding that must be there; empty: none may be, the error is below limits
    bool asExpected = false;
    std::string found; ///< what was said
};

/// Puts one fault after the other into the picture and compares it, with the limits of `options`. What an
/// error of the values must lead to is computed apart, by plain loops. Throws Error{InvalidContent} if the
/// picture does not even pass against itself.
std::vector<Injection> injectFaults(const Picture& picture, const CompareOptions& options);

/// injectFaults() of a file, printed. Returns 0 if all went as expected; else throws Error{Internal}.
int runSelfTest(const Options& options);

} // namespace rt

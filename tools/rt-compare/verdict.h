#pragma once
#include "common/error.h"

#include <cstddef>

namespace rt {

/// What came of a pair, or of all of them. Error: they could not be compared.
enum class Verdict { Pass, Fail, Error };

constexpr const char* verdictName(Verdict verdict) {
    return verdict == Verdict::Pass ? "pass" : verdict == Verdict::Fail ? "fail" : "error";
}

constexpr Verdict verdictOf(int exitCode) {
    return exitCode == 0 ? Verdict::Pass : exitCode == kExitImagesDiffer ? Verdict::Fail : Verdict::Error;
}

/// Pairs by their verdicts.
struct Totals {
    std::size_t pairs = 0, failing = 0, unreadable = 0;

    void add(Verdict verdict) {
        ++pairs;
        failing += verdict == Verdict::Fail ? 1u : 0u;
        unreadable += verdict == Verdict::Error ? 1u : 0u;
    }
    Verdict verdict() const {
        return unreadable > 0 ? Verdict::Error : failing > 0 ? Verdict::Fail : Verdict::Pass;
    }
};

} // namespace rt

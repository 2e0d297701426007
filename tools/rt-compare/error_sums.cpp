#include "tools/rt-compare/error_sums.h"

#include "common/wide_lanes.h"
#include "tools/rt-compare/float_lanes.h"

#include <array>
#include <cmath>
#include <cstring>
#include <span>
#include <vector>

namespace rt {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Of values that are finite.
RT_WIDE_LANES void addRange(std::span<const float> values, RangeSums& range) {
    if (values.empty()) return;
    Floats least = allFloats(values[0]), most = least;
    Doubles sums[2] = {};
    const std::size_t whole = values.size() / kLanes * kLanes;
    for (std::size_t i = 0; i < whole; i += kLanes) {
        const float* const from = values.data() + i;
        least = lesser(loadFloats(from), least);
        most = greater(loadFloats(from), most);
        sums[0] += loadDoubles(from);
        sums[1] += loadDoubles(from + kDoubleLanes);
    }
    RangeSums found{values[0], values[0], sumOf(sums[0] + sums[1]), values.size()};
    const auto include = [&found](float value) {
        found.min = std::min<double>(found.min, value);
        found.max = std::max<double>(found.max, value);
    };
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
        include(least[lane]);
        include(most[lane]);
    }
    for (std::size_t i = whole; i < values.size(); ++i) {
        include(values[i]);
        found.sum += values[i];
    }
    range.add(found);
}

struct LaneSums {
    Doubles difference{}, absolute{}, square{}, relative{}, symmetric{}, maxAbs{};

    // Doubles hold the difference of finite floats. Equal values add nothing.
    Doubles add(const Doubles& va, const Doubles& vb) {
        constexpr double kEpsilon = 1e-2;
        const Doubles d = va - vb, size = d < 0.0 ? -d : d;
        const Doubles sizeA = va < 0.0 ? -va : va, sizeB = vb < 0.0 ? -vb : vb;
        difference += d;
        absolute += size;
        square += d * d;
        relative += d * d / (vb * vb + kEpsilon);
        symmetric += size / (sizeA + sizeB + kEpsilon);
        maxAbs = size > maxAbs ? size : maxAbs;
        return size;
    }
};

// Adds values that are finite; errors[i] becomes |a - b|.
RT_WIDE_LANES void addErrors(std::span<const float> a, std::span<const float> b, double* errors,
                             ErrorSums& sums) {
    LaneSums lanes;
    const std::size_t whole = a.size() / kDoubleLanes * kDoubleLanes, rest = a.size() - whole;
    for (std::size_t i = 0; i < whole; i += kDoubleLanes) {
        const Doubles found = lanes.add(loadDoubles(a.data() + i), loadDoubles(b.data() + i));
        std::memcpy(errors + i, &found, sizeof found);
    }
    float restA[kDoubleLanes] = {}, restB[kDoubleLanes] = {};
    std::copy_n(a.data() + whole, rest, restA);
    std::copy_n(b.data() + whole, rest, restB);
    const Doubles found = lanes.add(loadDoubles(restA), loadDoubles(restB));
    std::memcpy(errors + whole, &found, rest * sizeof(double));
    sums.compared += a.size();
    sums.difference += sumOf(lanes.difference);
    sums.absolute += sumOf(lanes.absolute);
    sums.square += sumOf(lanes.square);
    sums.relative += sumOf(lanes.relative);
    sums.symmetric += sumOf(lanes.symmetric);
    for (std::size_t lane = 0; lane < kDoubleLanes; ++lane)
        sums.maxAbs = std::max(sums.maxAbs, lanes.maxAbs[lane]);
}

// Of a block some of whose values are ignored or not finite: the others, close together.
struct Sieve {
    std::vector<float> a, b;         // finite in both
    std::vector<std::size_t> places; // of these
    std::vector<float> finiteA, finiteB;
    std::uint64_t values = 0;

    // errors[i] becomes kIgnored, or what a difference that is not finite counts as.
    Sieve(const float* fromA, const float* fromB, const std::uint8_t* ignored, std::size_t count,
          double* errors) {
        for (std::size_t i = 0; i < count; ++i) {
            errors[i] = kIgnored;
            if (ignored && ignored[i]) continue;
            ++values;
            const float va = fromA[i], vb = fromB[i];
            if (std::isfinite(va)) finiteA.push_back(va);
            if (std::isfinite(vb)) finiteB.push_back(vb);
            if (!std::isfinite(va) || !std::isfinite(vb)) {
                errors[i] = va == vb || (std::isnan(va) && std::isnan(vb)) ? 0.0 : kInfinity;
                continue;
            }
            a.push_back(va);
            b.push_back(vb);
            places.push_back(i);
        }
    }
};

} // namespace

void measureBlock(const float* a, const float* b, const std::uint8_t* ignored, std::size_t count,
                  double* errors, ErrorSums& sums, ErrorCounts& counts) {
    std::array<std::uint32_t, kBlockPixels> bits;
    findErrorBits(a, b, ignored, count, bits.data());
    counts.add({bits.data(), count});
    if (*std::max_element(bits.begin(), bits.begin() + count) < kNoError) {
        addErrors({a, count}, {b, count}, errors, sums);
        addRange({a, count}, sums.a);
        addRange({b, count}, sums.b);
        sums.values += count;
        return;
    }
    const Sieve sieve(a, b, ignored, count, errors);
    std::array<double, kBlockPixels> found;
    addErrors(sieve.a, sieve.b, found.data(), sums);
    for (std::size_t i = 0; i < sieve.places.size(); ++i) errors[sieve.places[i]] = found[i];
    addRange(sieve.finiteA, sums.a);
    addRange(sieve.finiteB, sums.b);
    sums.values += sieve.values;
}

} // namespace rt

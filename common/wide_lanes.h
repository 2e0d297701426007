#pragma once

/// Compiles a function, and all that is inlined into it, once more for processors with AVX2, and takes that
/// where it runs. The results are the same: no operation is fused or reordered. Not without optimization,
/// which inlines nothing.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && defined(__OPTIMIZE__) &&              \
    !defined(__SANITIZE_ADDRESS__)
#define RT_WIDE_LANES __attribute__((target_clones("default", "arch=x86-64-v3"), flatten))
#else
#define RT_WIDE_LANES
#endif

// SPDX-License-Identifier: Apache-2.0
// The passes of a one-dimensional transform: which radices in which order, and twiddles.
// Theory: docs/theory/fft.md. Executed by fft_passes-inl.hpp.
#pragma once

#include <cstddef>
#include <vector>

namespace sateen::detail {

/// Transforms run side by side in a batch: one cache line of floats.
inline constexpr std::size_t kBatchLanes = 16;

/// One Stockham pass: `groups` · `stride` butterflies of `radix` points.
struct FftPass {
    std::size_t radix;
    std::size_t groups;    ///< values of p; n = radix · groups · stride
    std::size_t stride;    ///< product of the radices before, the values of q
    std::size_t twiddles;  ///< first twiddle of p = 1 in FftPlan1d::twiddles
};

struct FftPlan1d {
    /// \param n  an accepted size
    explicit FftPlan1d(std::size_t n);

    std::size_t size;
    std::vector<FftPass> passes;  ///< none for n = 1
    /// Per pass, p = 1 … groups - 1, k = 1 … radix - 1: cos, sin of -2π p k / (radix ·
    /// groups).
    std::vector<float> twiddles;
};

/// Scratch memory for one batch is two buffers of split-complex points, four parts of
/// whole tiles each 16 lines beyond a multiple of 4 KB: the points of a butterfly are
/// often 4 KB apart, and so the four parts use different sets of a cache of 64 sets.
[[nodiscard]] inline std::size_t scratch_part_floats(const FftPlan1d& plan) {
    constexpr std::size_t kPage = 1024;
    constexpr std::size_t kSkew = 16 * kBatchLanes;
    return (plan.size * kBatchLanes + kPage - 1) / kPage * kPage + kSkew;
}
[[nodiscard]] inline std::size_t scratch_floats(const FftPlan1d& plan) {
    return 4 * scratch_part_floats(plan);
}

/// Blocks [first, last) of a pass over a plane, and memory to do them in.
struct BlockRange {
    std::size_t first;
    std::size_t last;
    float* scratch;
};

}  // namespace sateen::detail

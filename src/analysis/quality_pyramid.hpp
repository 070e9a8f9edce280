// SPDX-License-Identifier: Apache-2.0
// The complex steerable pyramid of [Portilla & Simoncelli 2000], analysis only, in the
// frequency domain.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "sateen/core/fft.hpp"
#include "sateen/core/image.hpp"
#include "sateen/core/result.hpp"

namespace sateen::quality {

inline constexpr std::size_t kOrientations = 4;

/// One scale: (kOrientations, rows, cols) each.
struct PyramidLevel {
    Image re;         ///< even filters
    Image im;         ///< their Hilbert pairs
    Image magnitude;  ///< √(re² + im²)
};

struct SteerableBands {
    Image high;                        ///< (1, rows, cols)
    std::vector<PyramidLevel> levels;  ///< fine to coarse, each half the size
    Image low;                         ///< (1, rows / 2^levels, cols / 2^levels)
};

/// The filters for one size, computed once.
class SteerablePyramid {
  public:
    /// How many levels a piece of this size supports: the coarsest has 16 sites a side.
    [[nodiscard]] static std::size_t levels_for(std::size_t rows, std::size_t cols);
    /// Sizes must be multiples of 2^(levels + 1).
    [[nodiscard]] static Result<SteerablePyramid> create(std::size_t rows,
                                                         std::size_t cols,
                                                         std::size_t levels);
    /// \param spectrum  half spectrum, unnormalised, of the finest level
    [[nodiscard]] SteerableBands decompose(const SplitComplexPlane& spectrum) const;
    [[nodiscard]] const Fft2d& fft() const { return stages_.front().fft; }

  private:
    struct Stage {
        Fft2d fft;
        Image even;     ///< (kOrientations, rows, spectrum cols): radial x |cos³|
        Image odd;      ///< the same, with the sign of the half plane
        Image lowpass;  ///< (1, rows, spectrum cols): what the next stage sees
    };
    explicit SteerablePyramid(std::vector<Stage> stages, Fft2d low_fft, Image entry)
        : stages_(std::move(stages)),
          low_fft_(std::move(low_fft)),
          entry_(std::move(entry)) {}

    std::vector<Stage> stages_;
    Fft2d low_fft_;
    Image entry_;  ///< (2, …): high-pass residual, and the low-pass the stages start from
};

class Features;

/// Marginal statistics of every band of every visible plane, and correlations between
/// bands.
void add_subbands(const std::vector<SteerableBands>& planes,
                  const std::vector<double>& weights, Features& features);
void add_joint(const std::vector<SteerableBands>& planes,
               const std::vector<double>& weights, Features& features);

}  // namespace sateen::quality

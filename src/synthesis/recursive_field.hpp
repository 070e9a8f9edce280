// SPDX-License-Identifier: Apache-2.0
// One plane of 2D causal autoregressive fields, drawn by their recursion, level by level,
// as [CAR2] does. Theory: docs/theory/causal_recursion.md.
#pragma once

#include <cstdint>
#include <vector>

#include "sateen/core/result.hpp"
#include "synthesis/causal_recursion.hpp"
#include "synthesis/spectral_density.hpp"

namespace sateen {

/// The infinite lattice is cut into blocks fixed to its origin. Every block starts the
/// recursion from zero in a margin wide enough for the start to be forgotten, so any
/// block can be drawn alone and always comes out the same; neighbours agree to 1e-3 of
/// the deviation.
class RecursiveField {
  public:
    /// \error not_stationary  a level's response to one impulse does not die out within
    ///                        kLongestMargin sites
    /// \error unsupported     a level's field is not a 2D CAR
    [[nodiscard]] static Result<RecursiveField> create(const PlaneField& field);
    [[nodiscard]] Result<void> draw(std::uint64_t seed, std::uint32_t plane,
                                    std::int32_t row, std::int32_t col,
                                    PlaneView<float> out, Executor& executor) const;
    [[nodiscard]] std::size_t strip_rows() const;

    static constexpr std::size_t kLongestMargin = 192;

  private:
    /// How far an impulse is felt, in sites.
    struct Margin {
        std::size_t down = 0;
        std::size_t left = 0;
        std::size_t right = 0;
    };
    struct LevelRecursion {
        std::vector<CausalTap> taps;
        float deviation = 0;
        Margin margin;
    };
    static Result<Margin> impulse_margin(const LevelRecursion& level, std::size_t number);
    [[nodiscard]] Result<Image> draw_block(std::uint64_t seed, std::uint32_t plane,
                                           std::int32_t row, std::int32_t col) const;

    std::vector<LevelRecursion> levels_;
};

}  // namespace sateen

// SPDX-License-Identifier: Apache-2.0
// One plane of 2D causal autoregressive fields, drawn by their recursion, level by level,
// as [CAR2] does. Theory: docs/theory/causal_recursion.md.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "sateen/core/image.hpp"
#include "sateen/core/normal.hpp"
#include "sateen/core/parallel.hpp"
#include "sateen/core/pyramid.hpp"
#include "sateen/core/result.hpp"
#include "synthesis/causal_recursion.hpp"
#include "synthesis/spectral_density.hpp"

namespace sateen {

/// The infinite lattice is cut into blocks fixed to its origin. Every block starts the
/// recursion from zero in a margin wide enough for the start to be forgotten, so any
/// block can be drawn alone and always comes out the same; neighbours agree to about 1e-3
/// of the deviation, in the root mean square.
class RecursiveField {
  public:
    /// \error not_stationary  a level's response to one impulse does not die out within
    ///                        kLongestMargin sites
    /// \error unsupported     a level's field is not a 2D CAR
    [[nodiscard]] static Result<RecursiveField> create(const PlaneField& field);
    /// A window of the lattice. The same bits at a site for any window and executor.
    /// \param plane  numbers the noise
    /// \cost  beside the window, O(block side · margin) sites a block: about one ns a site
    ///        and three taps, and its noise. 0.35 MB a thread.
    [[nodiscard]] Result<void> draw(std::uint64_t seed, std::uint32_t plane,
                                    std::int32_t row, std::int32_t col,
                                    PlaneView<float> out, Executor& executor) const;
    /// Rows of a block: windows of as many, on block borders, draw nothing twice.
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
    /// The sites of a level that a block consists of.
    struct Window {
        LatticeRange rows;
        LatticeRange cols;
    };
    /// A coarser level to add, if it has any sites.
    struct Expanded {
        PlaneView<const float> field;
        LatticePoint origin;
    };
    /// The part of a block from site `from` on, of the size of `out`.
    [[nodiscard]] Result<void> draw_part(std::uint64_t seed, std::uint32_t plane,
                                         LatticePoint block, LatticePoint from,
                                         PlaneView<float> out) const;
    [[nodiscard]] Result<void> draw_level(std::size_t level, NoiseField noise,
                                          const Window& block, const Expanded& coarser,
                                          LatticePoint from, PlaneView<float> out) const;

    std::vector<LevelRecursion> levels_;
};

}  // namespace sateen

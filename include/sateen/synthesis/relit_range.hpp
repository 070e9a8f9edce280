// SPDX-License-Identifier: Apache-2.0
// The relit range map: what a smooth texture is displaced and multiplied by.
// Theory: docs/theory/evaluation.md, docs/theory/delighting.md.
#pragma once

#include <array>
#include <cstddef>

#include "sateen/core/direction.hpp"
#include "sateen/core/image.hpp"
#include "sateen/core/parallel.hpp"
#include "sateen/material/surface.hpp"
#include "sateen/synthesis/interpolate.hpp"

namespace sateen {

/// The range map of a material as a view sees it under a light,
///
///     s(x) = (max(0, n(x')·l) / mean + a) / (1 + a),
///
/// a = Surface::ambient, x' where the ray of sight through x meets the surface
/// [CAR2, section III]. What Evaluator does at a point with Relief::marched, for whole
/// windows.
class RelitRange {
  public:
    /// \param surface  valid, outlives this
    RelitRange(const Surface& surface, Direction view, Direction light);

    /// How s is distributed over all tiles.
    [[nodiscard]] const FactorShape& shape() const { return shape_; }
    /// Pixels beside a window whose heights and texture its pixels may show.
    [[nodiscard]] std::size_t margin() const { return margin_; }

    /// s · texture, both where the rays of sight meet the surface.
    /// \param texture    (bands, rows, cols)
    /// \param height_px  (1, rows, cols) at the same pixels
    /// \param torus      both continue across their borders; else the result lacks margin()
    ///                   pixels on every side
    [[nodiscard]] Image times(const Image& texture, const Image& height_px, bool torus,
                              Executor& executor) const;

  private:
    void take_statistics(const Surface& surface);

    std::array<float, 3> light_;
    float cols_per_z_ = 0;
    float rows_per_z_ = 0;
    float lowest_ = 0;
    float highest_ = 0;
    float scale_ = 1;  // 1 / (1 + a) over the mean of max(0, n·l)
    float floor_ = 0;  // a / (1 + a)
    FactorShape shape_;
    bool displaces_ = false;
    std::size_t margin_ = 1;
};

}  // namespace sateen

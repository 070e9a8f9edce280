// SPDX-License-Identifier: Apache-2.0
// From drawn planes to reflectance. See appearance.hpp.
#include "synthesis/appearance.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "sateen/core/colour.hpp"

namespace sateen {
namespace {

/// q(g) of one plane, in plane units: value and slope at each knot.
class Curve {
  public:
    explicit Curve(const Marginal& marginal) : scale_(marginal.scale) {
        if (marginal.knots.empty()) return;
        straight_ = false;
        for (std::size_t j = 0; j < Marginal::kKnots; ++j)
            value_[j] = marginal.knots[j] * scale_;
    }
    [[nodiscard]] float operator()(float g) const {
        if (straight_) return scale_ * g;
        constexpr float kSteps = Marginal::kKnots - 1;
        const float x =
            (std::clamp(g, -Marginal::kRange, Marginal::kRange) + Marginal::kRange) *
            (kSteps / (2 * Marginal::kRange));
        const auto j = std::min(static_cast<std::size_t>(x), Marginal::kKnots - 2);
        return value_[j] + (x - static_cast<float>(j)) * (value_[j + 1] - value_[j]);
    }

  private:
    std::array<float, Marginal::kKnots> value_{};
    float scale_;
    bool straight_ = true;
};

/// srgb_decode by linear interpolation in a table over [0, 1], exact beyond.
class DecodeTable {
  public:
    DecodeTable() : values_(kSteps + 2) {
        for (std::size_t i = 0; i < values_.size(); ++i)
            values_[i] = static_cast<float>(
                srgb_decode(static_cast<double>(i) / static_cast<double>(kSteps)));
    }
    [[nodiscard]] float operator()(float code) const {
        if (!(code < 1)) return srgb_decode(code);
        const float x = std::max(code, 0.0F) * static_cast<float>(kSteps);
        const auto i = static_cast<std::size_t>(x);
        return values_[i] + (x - static_cast<float>(i)) * (values_[i + 1] - values_[i]);
    }

  private:
    static constexpr std::size_t kSteps = 4096;
    std::vector<float> values_;
};

}  // namespace

void invert_spectral(const Subspace& subspace, ImageView<float> planes,
                     Executor& executor) {
    const std::size_t d = planes.bands;
    const SpectralTransform& transform = subspace.spectral;
    std::vector<Curve> curves;
    for (const Marginal& marginal : subspace.marginals) curves.emplace_back(marginal);
    const DecodeTable decode;

    parallel_for(executor, planes.rows, [&](std::size_t r) {
        std::array<float*, kMaxBands> row{};
        for (std::size_t band = 0; band < d; ++band)
            row[band] = planes.plane(band).row(r);
        for (std::size_t c = 0; c < planes.cols; ++c) {
            std::array<float, kMaxBands> q{};
            for (std::size_t i = 0; i < d; ++i) q[i] = curves[i](row[i][c]);
            for (std::size_t band = 0; band < d; ++band) {
                float value = transform.mean[band];
                for (std::size_t i = 0; i < d; ++i)
                    value += transform.T[i * d + band] * q[i];
                row[band][c] =
                    transform.tone == Tone::srgb ? decode(value) : std::max(value, 0.0F);
            }
        }
    });
}

}  // namespace sateen

// SPDX-License-Identifier: Apache-2.0
// Bilinear sampling of toroidal textures of four channels.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace sateen {

/// The four texels around a point and their shares. Texel (row, col) has its middle at
/// u = (col + 1/2) / side, v = -(row + 1/2) / side.
struct BilinearTaps {
    std::array<std::size_t, 4> at;  ///< of floats
    std::array<float, 4> share;

    BilinearTaps(float u, float v, std::size_t side) {
        const Axis col(u, side);
        const Axis row(-v, side);
        at = {4 * (row.first * side + col.first), 4 * (row.first * side + col.second),
              4 * (row.second * side + col.first), 4 * (row.second * side + col.second)};
        share = {(1 - row.part) * (1 - col.part), (1 - row.part) * col.part,
                 row.part * (1 - col.part), row.part * col.part};
    }

  private:
    struct Axis {
        std::size_t first;
        std::size_t second;
        float part;
        Axis(float turns, std::size_t side) {
            // Floors by conversion: the library's is a call without SSE 4.1.
            const float rest =
                turns - static_cast<float>(static_cast<std::int64_t>(turns));
            const float x =
                (rest < 0 ? rest + 1 : rest) * static_cast<float>(side) + 0.5F;
            const auto next = static_cast<std::size_t>(x);  // 0 … side
            first = next == 0 ? side - 1 : next - 1;
            second = next == side ? 0 : next;
            part = x - static_cast<float>(next);
        }
    };
};

/// A weighted sum of samples; the compiler makes vectors of its loops.
class Texel {
  public:
    void add(const float* texels, const BilinearTaps& taps, float weight) {
        for (std::size_t k = 0; k < 4; ++k) {
            const float* from = texels + taps.at[k];
            const float share = weight * taps.share[k];
            for (std::size_t c = 0; c < 4; ++c) sum_[c] += share * from[c];
        }
    }
    [[nodiscard]] const std::array<float, 4>& value() const { return sum_; }

  private:
    alignas(16) std::array<float, 4> sum_ = {};
};

}  // namespace sateen

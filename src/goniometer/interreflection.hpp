// SPDX-License-Identifier: Apache-2.0
// Light scattered once between parts of the surface.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "goniometer/tracer.hpp"
#include "sateen/core/image.hpp"

namespace sateen::goniometer {

/// What every pixel centre sees of the others:
///
///     J_i = 1/π ∫ ρ(y) E(y) max(0, n_i·ω) dω ≈ 4/K Σ_k ρ(y_ik) E(y_ik) max(0, n_i·ω_k)
///
/// over K directions spread evenly on the sphere (a Fibonacci lattice), the same at every
/// pixel, so that rays are coherent and the sum has no noise. y_ik is what the ray from i
/// along ω_k meets, taken at the nearest pixel centre, E its irradiance; ρ_i J_i is then
/// π times the radiance scattered on.
class Interreflection {
  public:
    Interreflection() = default;
    /// \cost one ray a pixel and direction
    Interreflection(const Tracer& tracer, std::size_t rows, std::size_t cols, float width,
                    float depth, std::size_t directions, Executor& executor);

    /// J under one light, (3, rows, cols). \cost one shadow ray a pixel
    [[nodiscard]] Image gather(const Tracer& tracer, const Vector& light,
                               bool shadows) const;

  private:
    struct Link {
        std::uint32_t pixel = 0;
        float weight = 0;
    };
    std::size_t rows_ = 0;
    std::size_t cols_ = 0;
    Hits centres_;
    std::vector<std::vector<Link>> links_;  ///< of each block, in order of its pixels
    std::vector<std::array<std::uint32_t, kLanes + 1>> begins_;
};

}  // namespace sateen::goniometer

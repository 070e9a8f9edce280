// SPDX-License-Identifier: Apache-2.0
// Textures on a torus, by one transform a plane.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "sateen/core/fft.hpp"
#include "sateen/core/image.hpp"
#include "sateen/core/parallel.hpp"
#include "sateen/core/result.hpp"
#include "sateen/material/material.hpp"
#include "sateen/synthesis/synthesise.hpp"
#include "synthesis/finish.hpp"

namespace sateen {

/// Tileable textures up to this size are drawn at once, with mean and variance pinned.
inline constexpr std::size_t kWholeTextureSites = std::size_t{1} << 22U;

[[nodiscard]] bool fits_one_transform(const SynthesisOptions& options);

[[nodiscard]] inline Period period_of(const SynthesisOptions& options) {
    return {static_cast<std::int32_t>(options.rows),
            static_cast<std::int32_t>(options.cols)};
}

/// Noise and textures of all planes of a material on one torus.
class Torus {
  public:
    /// \param material  kept by reference
    static Result<Torus> create(const Material& material,
                                const SynthesisOptions& options);

    /// The noise of every plane as a spectrum.
    [[nodiscard]] std::vector<SplitComplexPlane> noise(Executor& executor) const;

    /// The texture of one subspace.
    /// \param noise  noise(), or nothing: drawn for this texture alone
    [[nodiscard]] Image draw(const Subspace& subspace, const Finish& finish,
                             std::span<const SplitComplexPlane> noise,
                             Executor& executor) const;

  private:
    Torus(Fft2d fft, const Material& material, std::uint64_t seed)
        : fft_(std::move(fft)), material_(&material), seed_(seed) {}
    [[nodiscard]] std::vector<SplitComplexPlane> spectra() const;
    template <class FinishRows>
    [[nodiscard]] Image draw_rows(const Subspace& subspace,
                                  std::span<const SplitComplexPlane> noise,
                                  const FinishRows& finish, Executor& executor) const;

    Fft2d fft_;
    const Material* material_;
    std::uint64_t seed_;
};

}  // namespace sateen

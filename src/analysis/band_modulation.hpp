// SPDX-License-Identifier: Apache-2.0
// How the amplitude of the bands of a texture varies. Theory: docs/theory/band_modulation.md.
// Partner: material/modulate.
#pragma once

#include <optional>
#include <vector>

#include "sateen/core/image.hpp"
#include "sateen/core/parallel.hpp"
#include "sateen/core/result.hpp"
#include "sateen/material/material.hpp"

namespace sateen {

/// The fields, which the subspaces of a material have in common, and the curves of one.
struct SharedModulation {
    BandModulation fields;
    SubspaceModulation curves;
};

struct ModulationFit {
    SharedModulation modulation;
    std::vector<Marginal> marginals;  ///< of the modulated planes
    /// Variance of the octaves of amplitude of the first plane that Gaussian fields lack,
    /// mean over its bands.
    double excess = 0;
};

/// Bands whose amplitude varies less than so much, in octaves squared, are left Gaussian: what
/// can be seen, and what samples of this size show of fields that are Gaussian.
[[nodiscard]] constexpr double least_excess(std::size_t pixels) {
    return 0.03 + 1300 / static_cast<double>(pixels);
}

struct ModulationOptions {
    /// Found on another subspace: the fields stay, the curves are a start.
    const SharedModulation* shared = nullptr;
    /// The planes are drawn together: what they have in common is no excess.
    bool joint = false;
    /// Planes that are not modulated; none, or one of each. The first never is one.
    std::vector<bool> left_alone;
};

/// \param planes     of one image, (d, rows, cols), accepted FFT sizes
/// \param marginals  of the planes
[[nodiscard]] Result<ModulationFit> fit_band_modulation(
    const Image& planes, const std::vector<Marginal>& marginals,
    const ModulationOptions& options, Executor& executor);

}  // namespace sateen

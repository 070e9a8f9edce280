// SPDX-License-Identifier: Apache-2.0
// Segmentation of the BTF space: which images look alike, and which stands for them.
// Theory: docs/theory/segmentation.md.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "sateen/analysis/reflectance.hpp"
#include "sateen/core/parallel.hpp"
#include "sateen/core/progress.hpp"
#include "sateen/core/result.hpp"
#include "sateen/measurement/measurement.hpp"

namespace sateen {

struct SegmentationOptions {
    /// K, 1 … kMaxSubspaces; 0: the smallest found that explains `share`, at most
    /// kMaxSubspaces.
    std::size_t subspaces = 0;
    /// Of the variance of the features, that automatic K explains; in (0, 1].
    double share = 0.95;
    std::uint64_t seed = 0;
    /// Starts of K-means, of which the best is kept; 1 … 1000.
    std::uint32_t restarts = 10;
    /// Weight of the anisotropy of contrast beside the colour histograms, ≥ 0. Without it,
    /// images lit from φ and φ + 90° fall into one subspace; [CAR2] and [SAR] have 0.
    double orientation_weight = 6;
    /// Weight of the side that contrast is lit from, ≥ 0. Without it, images lit from φ and φ + 180°
    /// fall into one subspace, and where a pattern is lit its blends with others cancel.
    double side_weight = 1;
    /// How much a grazing view counts against an image as representative, ≥ 0; 0 in
    /// [CAR2].
    double grazing_penalty = 1;
    /// Go on past unreadable images.
    bool skip_bad = false;
};

/// The label of an observation that could not be read.
inline constexpr std::uint8_t kUnreadable = 255;

/// A partition of the observations of a measurement into K subspaces, dark to light.
struct Segmentation {
    std::vector<std::uint8_t> labels;  ///< subspace per observation, or kUnreadable
    std::vector<std::size_t>
        representatives;                 ///< observation per subspace, a member of it
    std::vector<std::uint32_t> members;  ///< observations per subspace, at least 1
    double explained = 0;  ///< share of the variance of the features; 0 for one subspace
    /// Shares of that variance along the principal components of the features, descending,
    /// as many as there are not below 1e-6 [CAR2, figure 4].
    std::vector<double> eigenvalues;
    PassReport pass;                    ///< of the reading of the images
    std::vector<ImageMoments> moments;  ///< of every observation that could be read
};

/// Segments the BTF space [CAR2, section II.A; SAR, section 2]: cumulative Lab histograms
/// of all images, K-means, and for each cluster the real image nearest its centre.
///
/// The representative of cluster k is the member i of least
///
///     ‖f_i - c_k‖² / r_k² + grazing_penalty (1 - cos θ_v,i)
///
/// r_k² the mean squared distance of the members from their centre. There are fewer
/// subspaces than asked for only if there are fewer distinct features. Same result for
/// any executor.
/// \error invalid_argument  an option out of its range, or a measurement without images;
///                          io, bad_format  of reading; cancelled
/// \cost one pass over the images, at about half the time of decoding JPEGs beside it,
///       then 0.2 to 0.4 s for 6561 images on one core; memory: about 3 KB an image,
///       whatever its size
[[nodiscard]] Result<Segmentation> segment(const Measurement& measurement,
                                           const SegmentationOptions& options,
                                           Executor& executor, Progress& progress);

}  // namespace sateen

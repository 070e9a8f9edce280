// SPDX-License-Identifier: Apache-2.0
// K-means clustering. Theory: docs/theory/segmentation.md. Naive reference:
// tests/reference/kmeans.hpp.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "sateen/core/image.hpp"
#include "sateen/core/parallel.hpp"

namespace sateen {

struct KMeansOptions {
    std::size_t clusters = 1;  ///< K, at least 1
    std::uint64_t seed = 0;
    std::uint32_t restarts = 10;  ///< independent starts, at least 1
    /// Points no further apart than this make no clusters of their own: they differ by
    /// rounding only.
    double resolution = 0;
};

/// A partition of points into clusters, each described by its mean.
struct Clustering {
    std::vector<std::uint32_t> labels;  ///< cluster of every point
    std::vector<double> centres;        ///< (clusters, features)
    std::size_t clusters = 0;
    /// Σ_i ‖x_i - c_label(i)‖², the quantity that is minimised
    double inertia = 0;
};

/// Partitions the rows of `points` (points, features) so that the sum of squared
/// distances to the cluster means is small: K-means++ [Arthur & Vassilvitskii 2007] and
/// Lloyd's iteration until no point changes its cluster, from `restarts` independent
/// starts, of which the one of least inertia is kept. Of 2048 points and more the starts
/// see a part, evenly spaced, and the one that fits it best goes on with all.
///
/// No cluster is empty. There are fewer clusters than asked for only if every point is
/// within `resolution` of a centre. Same result for any executor.
/// \cost a start: O(N K d) a step, of which the bounds of [Hamerly 2010] save most
[[nodiscard]] Clustering kmeans(PlaneView<const double> points,
                                const KMeansOptions& options, Executor& executor);

}  // namespace sateen

// SPDX-License-Identifier: Apache-2.0
// K-means++, and Lloyd's iteration with the distance bounds of Hamerly.
#include "sateen/analysis/kmeans.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

#include "sateen/core/normal.hpp"

namespace sateen {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Lloyd's iteration ends by itself: every step lowers the inertia or changes nothing.
// The limit guards against rounding making it go round in circles.
constexpr int kMaxSteps = 1000;

// Starts compete on so many points, evenly spaced; the best goes on with all of them.
constexpr std::size_t kStartPoints = 1024;

// Points are padded with zeros to a multiple of this many features, which are summed side
// by side: one running sum would wait for every addition.
constexpr std::size_t kLanes = 4;

// ‖x - y‖²; or, where the first features alone show that it is not below `limit`, a
// number not below it. Most centres are far off, and principal components tell so
// soonest.
double squared_distance(const double* x, const double* y, std::size_t features,
                        double limit = kInfinity) {
    std::array<double, kLanes> sum = {};
    const auto add = [&](std::size_t f) {
        for (std::size_t lane = 0; lane < kLanes; ++lane) {
            const double d = x[f + lane] - y[f + lane];
            sum[lane] += d * d;
        }
    };
    const auto total = [&] { return (sum[0] + sum[1]) + (sum[2] + sum[3]); };
    add(0);
    if (const double part = total(); part >= limit) return part;
    for (std::size_t f = kLanes; f < features; f += kLanes) add(f);
    return total();
}

// One start: seeding, then steps of assignment and update.
class Start {
  public:
    Start(PlaneView<const double> points, const KMeansOptions& options,
          std::uint32_t number)
        : points_(points),
          features_(points.cols),
          key_{static_cast<std::uint32_t>(options.seed),
               static_cast<std::uint32_t>(options.seed >> 32)},
          number_(number),
          label_(points.rows),
          upper_(points.rows),
          lower_(points.rows) {
        seed(options);
        iterate();
    }
    /// Goes on from the centres that other points led to.
    Start(PlaneView<const double> points, const Clustering& from)
        : points_(points),
          features_(points.cols),
          clusters_(from.clusters),
          centre_(from.centres),
          label_(points.rows),
          upper_(points.rows, kInfinity),
          lower_(points.rows) {
        iterate();
    }

    Clustering result() && {
        Clustering out;
        for (std::size_t i = 0; i < points_.rows; ++i)
            out.inertia += distance2(i, label_[i]);
        out.labels = std::move(label_);
        out.centres = std::move(centre_);
        out.clusters = clusters_;
        return out;
    }

  private:
    void iterate() {
        for (int step = 0; step < kMaxSteps; ++step) {
            if (!assign()) break;
            update();
        }
    }
    [[nodiscard]] const double* centre(std::size_t k) const {
        return centre_.data() + k * features_;
    }
    [[nodiscard]] double distance2(std::size_t i, std::size_t k,
                                   double limit = kInfinity) const {
        return squared_distance(points_.row(i), centre(k), features_, limit);
    }

    // Uniform in [0, 1), number `draw` of this start.
    [[nodiscard]] double uniform(std::size_t draw) const {
        const auto w =
            philox4x32_10({static_cast<std::uint32_t>(draw), number_, 0, 0}, key_);
        return std::ldexp(
            static_cast<double>(w[0] >> 5U) * 0x1p26 + static_cast<double>(w[1] >> 6U),
            -53);
    }

    // K-means++: every next centre is a point, drawn with probability proportional to its
    // squared distance from the nearest centre so far. Labels are those of the nearest.
    void seed(const KMeansOptions& options) {
        const double same = options.resolution * options.resolution;
        const std::size_t count = points_.rows;
        std::vector<double> nearest(count, kInfinity);
        auto next = static_cast<std::size_t>(uniform(0) * static_cast<double>(count));
        while (true) {
            centre_.insert(centre_.end(), points_.row(next),
                           points_.row(next) + features_);
            double total = 0;
            for (std::size_t i = 0; i < count; ++i) {
                const double d2 = distance2(i, clusters_, nearest[i]);
                if (d2 < nearest[i]) {
                    nearest[i] = d2;
                    label_[i] = static_cast<std::uint32_t>(clusters_);
                }
                if (nearest[i] > same) total += nearest[i];
            }
            ++clusters_;
            if (clusters_ == options.clusters || total == 0) break;
            next = draw(nearest, same, uniform(clusters_) * total);
        }
        for (std::size_t i = 0; i < count; ++i) upper_[i] = std::sqrt(nearest[i]);
    }

    // The first point at which the running sum of the weights above `least` exceeds
    // `target`, which is below the whole sum.
    static std::size_t draw(const std::vector<double>& weights, double least,
                            double target) {
        std::size_t at = 0;
        for (std::size_t i = 0; i < weights.size(); ++i) {
            if (!(weights[i] > least)) continue;
            at = i;
            target -= weights[i];
            if (target < 0) break;
        }
        return at;
    }

    // Gives every point to its nearest centre; false if that changed nothing.
    //
    // upper_ ≥ distance to the own centre, lower_ ≤ distance to all others, and no other
    // is nearer than half the way between the centres [Hamerly 2010]: where upper_ is
    // below either, the point stays, without a distance being computed.
    bool assign() {
        const std::vector<double> reach = half_gaps();
        bool changed = first_;
        first_ = false;
        for (std::size_t i = 0; i < points_.rows; ++i) {
            const double safe = std::max(lower_[i], reach[label_[i]]);
            if (upper_[i] < safe) continue;
            upper_[i] = std::sqrt(distance2(i, label_[i]));
            if (upper_[i] < safe) continue;
            changed |= assign_point(i);
        }
        return changed;
    }

    // Compares a point with all centres. It moves only to a strictly nearer one.
    bool assign_point(std::size_t i) {
        const std::uint32_t old = label_[i];
        double best = distance2(i, old);
        double second = kInfinity;
        for (std::uint32_t k = 0; k < clusters_; ++k) {
            if (k == old) continue;
            const double d2 = distance2(i, k, second);
            if (d2 < best) {
                second = best;
                best = d2;
                label_[i] = k;
            } else {
                second = std::min(second, d2);
            }
        }
        upper_[i] = std::sqrt(best);
        lower_[i] = std::sqrt(second);
        return label_[i] != old;
    }

    // Half the distance from each centre to the nearest other.
    [[nodiscard]] std::vector<double> half_gaps() const {
        std::vector<double> gap(clusters_, kInfinity);
        for (std::size_t k = 0; k < clusters_; ++k) {
            for (std::size_t other = 0; other < k; ++other) {
                const double d2 = squared_distance(centre(k), centre(other), features_);
                gap[k] = std::min(gap[k], d2);
                gap[other] = std::min(gap[other], d2);
            }
        }
        for (double& g : gap) g = std::sqrt(g) / 2;
        return gap;
    }

    // Moves every centre to the mean of its members, summed in order of the points, and
    // widens the bounds by how far the centres went.
    void update() {
        const std::vector<std::size_t> members = fill_empty();
        std::vector<double> mean(centre_.size());
        for (std::size_t i = 0; i < points_.rows; ++i) {
            const double* x = points_.row(i);
            double* sum = mean.data() + label_[i] * features_;
            for (std::size_t f = 0; f < features_; ++f) sum[f] += x[f];
        }
        for (std::size_t k = 0; k < clusters_; ++k) {
            for (std::size_t f = 0; f < features_; ++f)
                mean[k * features_ + f] /= static_cast<double>(members[k]);
        }
        std::swap(mean, centre_);
        std::vector<double> way(clusters_);
        for (std::size_t k = 0; k < clusters_; ++k) {
            way[k] = std::sqrt(
                squared_distance(centre(k), mean.data() + k * features_, features_));
        }
        const double longest = *std::max_element(way.begin(), way.end());
        for (std::size_t i = 0; i < points_.rows; ++i) {
            upper_[i] += way[label_[i]];
            lower_[i] -= longest;
        }
    }

    // Gives every cluster without members the point that fits its own cluster worst, and
    // returns the numbers of members. A cluster of one point gives none away.
    std::vector<std::size_t> fill_empty() {
        std::vector<std::size_t> members(clusters_);
        for (const std::uint32_t k : label_) ++members[k];
        for (std::size_t k = 0; k < clusters_; ++k) {
            if (members[k] != 0) continue;
            std::size_t worst = 0;
            double distance = -1;
            for (std::size_t i = 0; i < points_.rows; ++i) {
                const double d2 = distance2(i, label_[i]);
                if (members[label_[i]] > 1 && d2 > distance) {
                    distance = d2;
                    worst = i;
                }
            }
            --members[label_[worst]];
            ++members[k];
            label_[worst] = static_cast<std::uint32_t>(k);
            std::copy_n(points_.row(worst), features_,
                        centre_.begin() + static_cast<std::ptrdiff_t>(k * features_));
            // The centre jumped, so no bound holds any more.
            std::fill(upper_.begin(), upper_.end(), kInfinity);
            std::fill(lower_.begin(), lower_.end(), 0.0);
        }
        return members;
    }

    PlaneView<const double> points_;
    std::size_t features_;
    std::array<std::uint32_t, 2> key_ = {};
    std::uint32_t number_ = 0;
    std::size_t clusters_ = 0;
    bool first_ = true;  // the centres are not yet means
    std::vector<double> centre_;
    std::vector<std::uint32_t> label_;
    std::vector<double> upper_;
    std::vector<double> lower_;
};

}  // namespace

Clustering kmeans(PlaneView<const double> points, const KMeansOptions& options,
                  Executor& executor) {
    assert(points.rows > 0 && points.cols > 0);
    assert(options.clusters > 0 && options.restarts > 0);
    const std::size_t width = (points.cols + kLanes - 1) / kLanes * kLanes;
    const auto padded = [&](std::size_t every) {
        std::vector<double> values((points.rows + every - 1) / every * width);
        for (std::size_t i = 0; i < points.rows; i += every)
            std::copy_n(points.row(i), points.cols, values.data() + i / every * width);
        return values;
    };
    const auto view = [&](const std::vector<double>& values) {
        return PlaneView<const double>(values.data(), values.size() / width, width);
    };
    const std::size_t every = std::max<std::size_t>(1, points.rows / kStartPoints);
    const std::vector<double> some = padded(every);
    std::vector<Clustering> found(options.restarts);
    parallel_for(executor, found.size(), [&](std::size_t start) {
        found[start] =
            Start(view(some), options, static_cast<std::uint32_t>(start)).result();
    });
    // The first of equals, so that the choice does not depend on the executor.
    Clustering best = std::move(*std::min_element(
        found.begin(), found.end(),
        [](const Clustering& a, const Clustering& b) { return a.inertia < b.inertia; }));
    if (every > 1) best = Start(view(padded(1)), best).result();
    std::vector<double> centres(best.clusters * points.cols);
    for (std::size_t k = 0; k < best.clusters; ++k)
        std::copy_n(best.centres.data() + k * width, points.cols,
                    centres.data() + k * points.cols);
    best.centres = std::move(centres);
    return best;
}

}  // namespace sateen

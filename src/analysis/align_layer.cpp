// SPDX-License-Identifier: Apache-2.0
// Finding and bending the lattice of a texture. See periodic_layer.hpp.
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "analysis/alignment_step.hpp"
#include "analysis/periodic_layer.hpp"
#include "analysis/smooth_field.hpp"
#include "analysis/smooth_part.hpp"

namespace sateen {
namespace {

/// Slow changes of brightness wider than this many cells do not count.
constexpr double kSlow = 1.5;
constexpr int kIterations = 18;
constexpr int kWideIterations = 6;
/// Windows: in cells at first, then shrinking by kShrink to kFloor cells, but not below
/// kSmallestWindow pixels, where displacements begin to follow the noise.
constexpr double kFirstWindow = 0.45;
constexpr double kFloor = 0.08;
constexpr double kShrink = 0.75;
constexpr double kSmallestWindow = 5;
/// Cells smaller than this gain nothing from finer windows.
constexpr double kFineCell = 20;
/// A step is no longer than this share of the cell.
constexpr double kLongestStep = 0.15;
/// Sites of the displacement in the material, in cells.
constexpr double kSpacing = 0.35;
constexpr std::size_t kSmallestCell = 6;
constexpr std::size_t kLargestCell = 80;

class Alignment {
  public:
    Alignment(const Image& planes, const Lattice& lattice, Executor& executor)
        : executor_(executor),
          map_(lattice.a, lattice.b),
          cell_(std::sqrt(std::abs(lattice.area()))),
          shortest_(std::hypot(lattice.a[0], lattice.a[1])),
          P_(side_of(lattice.a)),
          Q_(side_of(lattice.b)),
          Y_(planes.bands(), planes.rows(), planes.cols()),
          D_(2, planes.rows(), planes.cols()) {
        const double slow =
            kSlow * std::max(shortest_, std::hypot(lattice.b[0], lattice.b[1]));
        for (std::size_t plane = 0; plane < planes.bands(); ++plane)
            subtract_smooth_part(planes.plane(plane), slow, Y_.plane(plane), executor);
    }

    void run() {
        const double floor = std::max(kSmallestWindow, kFloor * cell_);
        double window = std::max(kSmallestWindow, kFirstWindow * cell_);
        for (int i = 0; i < kIterations; ++i) {
            if (i >= kWideIterations && cell_ >= kFineCell)
                window = std::max(floor, window * kShrink);
            move_towards_cells(Y_, map_, {P_, Q_, window, kLongestStep * shortest_}, D_,
                               executor_);
            map_ = straighten(map_, D_, executor_);
        }
    }

    Result<AlignedLayer> result(double periodicity) && {
        AlignedLayer aligned;
        PeriodicLayer& layer = aligned.layer;
        layer.a = {static_cast<float>(map_.a()[0]), static_cast<float>(map_.a()[1])};
        layer.b = {static_cast<float>(map_.b()[0]), static_cast<float>(map_.b()[1])};
        layer.rows = static_cast<std::uint16_t>(P_);
        layer.cols = static_cast<std::uint16_t>(Q_);
        const double octave = std::floor(std::log2(std::max(1.0, kSpacing * cell_)));
        layer.spacing = static_cast<std::uint16_t>(
            std::min(std::exp2(octave), double{PeriodicLayer::kMaxSpacing}));
        for (std::size_t axis = 0; axis < 2; ++axis) {
            const Image sites = sampled(D_.plane(axis), layer.spacing);
            SATEEN_TRY(const CovarianceTable R,
                       covariances_of(sites.plane(0), executor_));
            layer.displacement[axis] = fit_smooth_field(R);
        }
        aligned.displacements.push_back(std::move(D_));
        aligned.periodicity = periodicity;
        return aligned;
    }

  private:
    static std::size_t side_of(const std::array<double, 2>& vector) {
        const auto length =
            static_cast<std::size_t>(std::lround(std::hypot(vector[0], vector[1])));
        return std::clamp(length, kSmallestCell, kLargestCell);
    }

    static Image sampled(PlaneView<const float> plane, std::size_t spacing) {
        Image result(1, (plane.rows + spacing - 1) / spacing,
                     (plane.cols + spacing - 1) / spacing);
        for (std::size_t r = 0; r < result.rows(); ++r)
            for (std::size_t c = 0; c < result.cols(); ++c)
                result(0, r, c) = plane(r * spacing, c * spacing);
        return result;
    }

    Executor& executor_;
    LatticeMap map_;
    double cell_;      ///< side of a square as large as the cell
    double shortest_;  ///< |a|
    std::size_t P_;
    std::size_t Q_;
    Image Y_;  ///< the planes without their slow changes
    Image D_;
};

}  // namespace

Result<std::optional<AlignedLayer>> align_layer(const Image& planes, Executor& executor) {
    SATEEN_TRY(const std::optional<Lattice> lattice,
               find_lattice(planes.plane(0), executor));
    if (!lattice) return std::optional<AlignedLayer>();
    Alignment alignment(planes, *lattice, executor);
    alignment.run();
    SATEEN_TRY(AlignedLayer layer, std::move(alignment).result(lattice->periodicity));
    return std::optional<AlignedLayer>(std::move(layer));
}

}  // namespace sateen

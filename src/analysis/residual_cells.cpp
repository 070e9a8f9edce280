// SPDX-License-Identifier: Apache-2.0
// How the residual of a pattern varies with the place in the cell. See periodic_layer.hpp.
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "analysis/fold.hpp"
#include "analysis/periodic_layer.hpp"
#include "sateen/material/cell_table.hpp"

namespace sateen {
namespace {

/// s², at least this share of its mean.
constexpr double kLeastEnergy = 0.01;
/// Planes of which others explain less than this share, by place, are left unmixed.
constexpr double kLeastExplained = 0.04;

/// The product of two planes of the residual.
std::vector<Image> products(std::span<const Image> residuals, std::size_t i,
                            std::size_t j) {
    std::vector<Image> result;
    for (const Image& residual : residuals) {
        Image& product = result.emplace_back(1, residual.rows(), residual.cols());
        for (std::size_t k = 0; k < residual.plane_size(); ++k)
            product.plane(0).data[k] =
                residual.plane(i).data[k] * residual.plane(j).data[k];
    }
    return result;
}

double mean_of(PlaneView<const float> plane) {
    double sum = 0;
    for (std::size_t i = 0; i < plane.size(); ++i)
        sum += static_cast<double>(plane.data[i]);
    return sum / static_cast<double>(plane.size());
}

class ResidualCells {
  public:
    ResidualCells(const AlignedLayer& aligned, std::vector<PeriodicCell>& cells,
                  std::vector<Image>& residuals, Executor& executor)
        : aligned_(aligned), cells_(cells), residuals_(residuals), executor_(executor) {}

    void run() {
        for (Image& residual : residuals_)
            for (std::size_t plane = 0; plane < residual.bands(); ++plane) {
                const auto mean = static_cast<float>(mean_of(residual.plane(plane)));
                const PlaneView<float> R = residual.plane(plane);
                for (std::size_t i = 0; i < R.size(); ++i) R.data[i] -= mean;
            }
        for (std::size_t plane = 0; plane < cells_.size(); ++plane) {
            if (plane > 0) fit_mixing(plane);
            fit_deviations(plane);
        }
    }

  private:
    /// E[R_i R_j | u] on the grid of `side`.
    Image covariance(std::size_t i, std::size_t j,
                     std::size_t (*side)(std::size_t)) const {
        const PeriodicLayer& layer = aligned_.layer;
        // Sites are half a step from the border.
        return fold(products(residuals_, i, j), LatticeMap(layer), aligned_.displacements,
                    side(layer.rows), side(layer.cols), executor_, 0.5);
    }

    void fit_deviations(std::size_t plane) {
        const Image energy = covariance(plane, plane, deviation_side);
        const double mean = mean_of(energy.plane(0));
        if (!(mean > 0)) return;
        std::vector<double> s;
        for (std::size_t i = 0; i < energy.plane_size(); ++i)
            s.push_back(std::sqrt(std::max(
                kLeastEnergy, static_cast<double>(energy.plane(0).data[i]) / mean)));
        const double step = *std::ranges::max_element(s) / 255;
        PeriodicCell& cell = cells_[plane];
        cell.deviation_step = static_cast<float>(step);
        cell.deviations.clear();
        for (const double value : s)
            cell.deviations.push_back(
                static_cast<std::uint8_t>(std::max(1L, std::lround(value / step))));
        for_pixels([&](const CellTable::Values& values, float* const* R) {
            *R[plane] /= values[CellTable::kPlanes + plane];
        });
    }

    /// l_ij = E[R_i R_j | u]/E[R_j² | u]: the R_j, j < i, have been made uncorrelated.
    void fit_mixing(std::size_t plane) {
        const Image energy = covariance(plane, plane, mixing_side);
        std::vector<double> slopes;
        double explained = 0;
        for (std::size_t j = 0; j < plane; ++j) {
            const Image product = covariance(plane, j, mixing_side);
            const Image other = covariance(j, j, mixing_side);
            const auto sites = static_cast<double>(product.plane_size());
            for (std::size_t i = 0; i < product.plane_size(); ++i) {
                const auto pair = static_cast<double>(product.plane(0).data[i]);
                const auto power = static_cast<double>(other.plane(0).data[i]);
                const auto own = static_cast<double>(energy.plane(0).data[i]);
                slopes.push_back(power > 0 ? pair / power : 0);
                if (power > 0 && own > 0)
                    explained += pair * pair / (power * own) / sites;
            }
        }
        if (explained < kLeastExplained) return;
        double largest = 0;
        for (const double l : slopes) largest = std::max(largest, std::abs(l));
        PeriodicCell& cell = cells_[plane];
        const double step = largest / 127;
        cell.mixing_step = static_cast<float>(step);
        for (const double l : slopes)
            cell.mixing.push_back(static_cast<std::int8_t>(std::lround(l / step)));
        for_pixels([&](const CellTable::Values& values, float* const* R) {
            for (std::size_t j = 0; j < plane; ++j)
                *R[plane] -= values[CellTable::mixing(plane, j)] * *R[j];
        });
    }

    /// Calls `change` with what the table of the cells has at each pixel, and the planes there.
    template <class Change>
    void for_pixels(Change change) {
        const CellTable table(aligned_.layer, cells_);
        const LatticeMap map(aligned_.layer);
        for (std::size_t k = 0; k < residuals_.size(); ++k) {
            Image& residual = residuals_[k];
            parallel_for(executor_, residual.rows(), [&](std::size_t r) {
                std::array<float*, CellTable::kPlanes> R{};
                for (std::size_t c = 0; c < residual.cols(); ++c) {
                    const auto u = phase_at(map, aligned_.displacements[k], r, c);
                    for (std::size_t plane = 0; plane < residual.bands(); ++plane)
                        R[plane] = &residual(plane, r, c);
                    change(table.at(u[0], u[1]), R.data());
                }
            });
        }
    }

    const AlignedLayer& aligned_;
    std::vector<PeriodicCell>& cells_;
    std::vector<Image>& residuals_;
    Executor& executor_;
};

}  // namespace

void fold_residual(const AlignedLayer& aligned, std::vector<PeriodicCell>& cells,
                   std::vector<Image>& residuals, Executor& executor) {
    ResidualCells(aligned, cells, residuals, executor).run();
}

}  // namespace sateen

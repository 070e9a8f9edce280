// SPDX-License-Identifier: Apache-2.0
// Slopes to height. See integrate.hpp.
#include "sateen/analysis/integrate.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "analysis/fourier.hpp"

namespace sateen {
namespace {

using Complex = std::complex<double>;

// Steeper slopes are those of single pixels in shadow.
constexpr double kLeastNormalZ = 0.15;
// Of |D|² against ω²: below it central differences tell noise rather than height.
constexpr double kLeastGain = 0.1;

Complex symbol(Difference difference, double omega) {
    switch (difference) {
        case Difference::band_limited:
            return {0, omega};
        case Difference::central:
            return {0, std::sin(omega)};
        case Difference::forward:
            return std::polar(1.0, omega) - 1.0;
    }
    return {};
}

/// At the Nyquist frequency a real derivative has no odd part.
Complex symbol(Difference difference, std::size_t k, std::size_t n) {
    if (difference != Difference::forward && 2 * k == n) return {};
    return symbol(difference, frequency(k, n));
}

BasicImage<double> integrate_torus(const SlopeField& slopes, Difference difference,
                                   std::size_t shear) {
    const std::size_t rows = slopes.rows();
    const std::size_t cols = slopes.cols();
    Spectrum P = lattice_spectrum(slopes.plane(0), shear);
    const Spectrum Q = lattice_spectrum(slopes.plane(1), shear);
    for (std::size_t n = 0; n < cols; ++n) {
        const Complex Dx = symbol(difference, n, cols);
        const double omega_x = frequency(n, cols);
        const double drift =
            omega_x * static_cast<double>(shear) / static_cast<double>(rows);
        for (std::size_t m = 0; m < rows; ++m) {
            const double omega_r =
                std::remainder(frequency(m, rows) - drift, 2 * std::numbers::pi);
            // y points against the rows.
            const Complex Dy = shear == 0 ? symbol(difference, (rows - m) % rows, rows)
                                          : symbol(difference, -omega_r);
            double gain = std::norm(Dx) + std::norm(Dy);
            if (difference == Difference::central)
                gain =
                    std::max(gain, kLeastGain * (omega_x * omega_x + omega_r * omega_r));
            const Complex sum = std::conj(Dx) * P(m, n) + std::conj(Dy) * Q(m, n);
            P(m, n) = gain > 0 ? sum / gain : Complex{};
        }
    }
    P(0, 0) = 0;
    return lattice_plane(P, shear);
}

/// Mirrored about the borders: p is odd along the columns, q along the rows.
SlopeField mirrored(const SlopeField& slopes) {
    const std::size_t rows = slopes.rows();
    const std::size_t cols = slopes.cols();
    SlopeField out(2, 2 * rows, 2 * cols);
    for (std::size_t r = 0; r < 2 * rows; ++r)
        for (std::size_t c = 0; c < 2 * cols; ++c) {
            const bool below = r >= rows;
            const bool beyond = c >= cols;
            const std::size_t from_r = below ? 2 * rows - 1 - r : r;
            const std::size_t from_c = beyond ? 2 * cols - 1 - c : c;
            out(0, r, c) = slopes(0, from_r, from_c) * (beyond ? -1 : 1);
            out(1, r, c) = slopes(1, from_r, from_c) * (below ? -1 : 1);
        }
    return out;
}

BasicImage<double> top_left(const BasicImage<double>& image, std::size_t rows,
                            std::size_t cols) {
    BasicImage<double> out(1, rows, cols);
    double sum = 0;
    for (std::size_t r = 0; r < rows; ++r)
        for (std::size_t c = 0; c < cols; ++c) sum += out(0, r, c) = image(0, r, c);
    for (double& z : out.values()) z -= sum / static_cast<double>(out.plane_size());
    return out;
}

}  // namespace

BasicImage<double> integrate(const SlopeField& slopes, Difference difference,
                             Periodicity periodicity, std::size_t shear) {
    if (periodicity == Periodicity::torus)
        return integrate_torus(slopes, difference, shear);
    return top_left(integrate_torus(mirrored(slopes), difference, 0), slopes.rows(),
                    slopes.cols());
}

SlopeField slopes_of(const BasicImage<double>& height, Difference difference) {
    const std::size_t rows = height.rows();
    const std::size_t cols = height.cols();
    const Spectrum Z = spectrum_of<double>(height.plane(0));
    SlopeField out(2, rows, cols);
    for (std::size_t band = 0; band < 2; ++band) {
        Spectrum slope(rows, cols);
        for (std::size_t m = 0; m < rows; ++m)
            for (std::size_t n = 0; n < cols; ++n)
                slope(m, n) =
                    Z(m, n) * (band == 0 ? symbol(difference, n, cols)
                                         : symbol(difference, (rows - m) % rows, rows));
        inverse(slope);
        for (std::size_t i = 0; i < slope.values.size(); ++i)
            out.plane(band).data[i] = slope.values[i].real();
    }
    return out;
}

SlopeField slopes_of_normals(const Image& normals) {
    SlopeField out(2, normals.rows(), normals.cols());
    for (std::size_t i = 0; i < normals.plane_size(); ++i) {
        const double z =
            std::max(kLeastNormalZ, static_cast<double>(normals.plane(2).data[i]));
        for (std::size_t band = 0; band < 2; ++band)
            out.plane(band).data[i] =
                -static_cast<double>(normals.plane(band).data[i]) / z;
    }
    return out;
}

void remove_tilt(BasicImage<double>& height) {
    Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
    Eigen::Vector3d b = Eigen::Vector3d::Zero();
    const auto centred = [](std::size_t i, std::size_t n) {
        return static_cast<double>(i) - (static_cast<double>(n) - 1) / 2;
    };
    for (std::size_t r = 0; r < height.rows(); ++r)
        for (std::size_t c = 0; c < height.cols(); ++c) {
            const Eigen::Vector3d x(1, centred(c, height.cols()),
                                    centred(r, height.rows()));
            A += x * x.transpose();
            b += x * height(0, r, c);
        }
    // A side of one pixel has no slope.
    const Eigen::Vector3d plane = A.completeOrthogonalDecomposition().solve(b);
    for (std::size_t r = 0; r < height.rows(); ++r)
        for (std::size_t c = 0; c < height.cols(); ++c)
            height(0, r, c) -= plane[0] + plane[1] * centred(c, height.cols()) +
                               plane[2] * centred(r, height.rows());
}

}  // namespace sateen

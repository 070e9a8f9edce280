// SPDX-License-Identifier: Apache-2.0
// The autocorrelation of a plane, read anywhere. See lattice_search.hpp.
#include <algorithm>
#include <utility>

#include "analysis/lattice_search.hpp"
#include "analysis/smooth_part.hpp"
#include "sateen/core/fft.hpp"

namespace sateen::lattice_search {
namespace {

std::array<double, 4> cubic_weights(double t) {
    return {((2 - t) * t - 1) * t / 2, ((3 * t - 5) * t * t + 2) / 2,
            ((4 - 3 * t) * t + 1) * t / 2, (t - 1) * t * t / 2};
}

/// Calls `visit(v)` for the lattice points of a half disc, shifted, in a fixed order. The
/// basis must be reduced.
template <class Visit>
void for_points(const Basis& basis, double radius, Vector shift, Visit visit) {
    const double det = std::abs(determinant(basis.a, basis.b));
    const auto k_most = static_cast<int>(radius * length(basis.b) / det) + 1;
    const auto l_most = static_cast<int>(radius * length(basis.a) / det) + 1;
    for (int k = 0; k <= k_most; ++k)
        for (int l = k == 0 ? 1 : -l_most; l <= l_most; ++l) {
            Vector v = combine(k, basis.a, l, basis.b);
            v = {v[0] + shift[0], v[1] + shift[1]};
            if (v[0] * v[0] + v[1] * v[1] <= radius * radius) visit(v);
        }
}

}  // namespace

Basis reduced(Basis basis) {
    auto& [a, b] = basis;
    for (int step = 0; step < 64; ++step) {
        if (length(a) > length(b)) std::swap(a, b);
        const double squared = a[0] * a[0] + a[1] * a[1];
        if (!(squared > 0)) return basis;
        const double times = std::round((a[0] * b[0] + a[1] * b[1]) / squared);
        if (times == 0) break;
        b = combine(1, b, -times, a);
    }
    if (a[0] < 0 || (a[0] == 0 && a[1] < 0)) a = {-a[0], -a[1]};
    if (determinant(a, b) < 0) b = {-b[0], -b[1]};
    return basis;
}

Result<Autocorrelation> Autocorrelation::of(PlaneView<const float> plane,
                                            Executor& executor) {
    Autocorrelation A;
    A.side_ = static_cast<double>(std::min(plane.rows, plane.cols));
    A.reach_ = std::min(plane.rows, plane.cols) / 2;
    Image padded(1, fft_size_at_least(plane.rows + A.reach_ + kMargin + 1),
                 fft_size_at_least(plane.cols + A.reach_ + kMargin + 1));
    subtract_smooth_part(plane, A.side_ / 6,
                         padded.plane(0).window(0, 0, plane.rows, plane.cols), executor);
    SATEEN_TRY(const Fft2d fft, Fft2d::create(padded.rows(), padded.cols()));
    SplitComplexPlane spectrum(fft.rows(), fft.spectrum_cols());
    fft.forward(padded.plane(0), spectrum.view(), executor);
    const SplitComplexView<float> S = spectrum.view();
    for (std::size_t m = 0; m < fft.rows(); ++m)
        for (std::size_t n = 0; n < fft.spectrum_cols(); ++n) {
            S.re(m, n) = S.re(m, n) * S.re(m, n) + S.im(m, n) * S.im(m, n);
            S.im(m, n) = 0;
        }
    fft.inverse(S, padded.plane(0), executor);
    A.gather(padded.plane(0), plane.rows, plane.cols);
    return A;
}

double Autocorrelation::operator()(Vector v) const {
    if (v[0] < 0) v = {-v[0], -v[1]};
    const double r = v[0] + kMargin;
    const double c = v[1] + static_cast<double>(reach_ + kMargin);
    const auto row = static_cast<std::size_t>(r);
    const auto col = static_cast<std::size_t>(c);
    const auto down = cubic_weights(r - static_cast<double>(row));
    const auto across = cubic_weights(c - static_cast<double>(col));
    double sum = 0;
    for (std::size_t i = 0; i < 4; ++i) {
        const float* A = values_.plane(0).row(row + i - 1) + col - 1;
        sum += down[i] * (across[0] * static_cast<double>(A[0]) +
                          across[1] * static_cast<double>(A[1]) +
                          across[2] * static_cast<double>(A[2]) +
                          across[3] * static_cast<double>(A[3]));
    }
    return sum;
}

// Unbiased: every lag divided by the pairs of pixels it has.
void Autocorrelation::gather(PlaneView<const float> sums, std::size_t rows,
                             std::size_t cols) {
    const std::size_t margin = reach_ + kMargin;
    values_ = Image(1, margin + kMargin + 1, 2 * margin + 1);
    const double variance =
        static_cast<double>(sums(0, 0)) / static_cast<double>(rows * cols);
    if (!(variance > 0)) return;
    for (std::size_t r = 0; r < values_.rows(); ++r)
        for (std::size_t c = 0; c < values_.cols(); ++c) {
            const std::size_t down = r >= kMargin ? r - kMargin : kMargin - r;
            const std::size_t across = c >= margin ? c - margin : margin - c;
            // A(-s) = A(s): lags of one sign only are looked up with rows ≥ 0.
            const bool mirrored = (r < kMargin) != (c < margin);
            const std::size_t col = mirrored && across > 0 ? sums.cols - across : across;
            const auto pairs = static_cast<double>((rows - down) * (cols - across));
            values_(0, r, c) = static_cast<float>(static_cast<double>(sums(down, col)) /
                                                  (pairs * variance));
        }
}

Mean mean_at_points(const Autocorrelation& A, const Basis& basis, double radius,
                    Vector shift, std::size_t most) {
    const double det = std::abs(determinant(basis.a, basis.b));
    if (!(det >= kSmallestArea / 2)) return {-1, 1};
    const double expected = 1.6 * radius * radius / det;
    const auto stride =
        static_cast<std::size_t>(expected / static_cast<double>(most)) + 1;
    Mean mean;
    std::size_t number = 0;
    for_points(basis, radius, shift, [&](Vector v) {
        if (number++ % stride != 0) return;
        mean.value += A(v);
        ++mean.points;
    });
    if (mean.points > 0) mean.value /= static_cast<double>(mean.points);
    return mean;
}

double radius_of(const Disc& disc, const Autocorrelation& A, const Basis& basis) {
    return std::min(disc.share * A.side(), disc.multiples * length(basis.b));
}

}  // namespace sateen::lattice_search

// SPDX-License-Identifier: Apache-2.0
// Shape from the shading of one photograph. See shape_from_shading.hpp.
#include "sateen/analysis/shape_from_shading.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "sateen/core/fft.hpp"
#include "sateen/core/periodic_part.hpp"

namespace sateen {
namespace {

constexpr std::size_t kSmallestSide = 16;
constexpr std::size_t kCoarsestSide = 48;
constexpr float kAssumedElevation = 45 * kRadiansPerDegree;
/// Of the step: 1 is stable, the projection being a contraction.
constexpr float kStep = 1;
/// Weight of the neighbours' mean in p̄, at the beginning of each scale; falls to 0.
constexpr float kSmoothing = 0.02F;
constexpr float kSteepest = 4;
/// Of the linear start, against the power of light along a wave.
constexpr float kDamping = 0.003F;

/// Luminance of the largest FFT-sized window in the middle.
Image luminance_window(const Image& image) {
    const std::size_t rows = fft_size_at_most(image.rows(), 2);
    const std::size_t cols = fft_size_at_most(image.cols(), 2);
    const std::size_t top = (image.rows() - rows) / 2;
    const std::size_t left = (image.cols() - cols) / 2;
    constexpr std::array<float, 3> kRec709 = {0.2126F, 0.7152F, 0.0722F};
    Image out(1, rows, cols);
    for (std::size_t band = 0; band < image.bands(); ++band) {
        const float weight = image.bands() == 1 ? 1 : kRec709[band];
        for (std::size_t r = 0; r < rows; ++r)
            for (std::size_t c = 0; c < cols; ++c)
                out(0, r, c) += weight * image(band, top + r, left + c);
    }
    return out;
}

/// Half the size, means of 2 x 2; of sizes that stay FFT sizes.
Image halved(const Image& image) {
    Image out(1, image.rows() / 2, image.cols() / 2);
    for (std::size_t r = 0; r < out.rows(); ++r)
        for (std::size_t c = 0; c < out.cols(); ++c)
            out(0, r, c) = (image(0, 2 * r, 2 * c) + image(0, 2 * r, 2 * c + 1) +
                            image(0, 2 * r + 1, 2 * c) + image(0, 2 * r + 1, 2 * c + 1)) /
                           4;
    return out;
}

double mean_of(const Image& image) {
    double sum = 0;
    for (const float v : image.values()) sum += static_cast<double>(v);
    return sum / static_cast<double>(image.values().size());
}

/// The azimuth along which the image varies most, that of the light or its opposite: of the
/// two the one from above [Pentland 1984; a surface varies alike in all directions].
Direction estimate_light(const Image& image) {
    double xx = 0;
    double yy = 0;
    double xy = 0;
    for (std::size_t r = 1; r + 1 < image.rows(); ++r)
        for (std::size_t c = 1; c + 1 < image.cols(); ++c) {
            const auto x = static_cast<double>(image(0, r, c + 1) - image(0, r, c - 1));
            const auto y = static_cast<double>(image(0, r - 1, c) - image(0, r + 1, c));
            xx += x * x;
            yy += y * y;
            xy += x * y;
        }
    double phi = 0.5 * std::atan2(2 * xy, xx - yy);
    if (phi < 0) phi += std::numbers::pi;
    return {std::numbers::pi_v<float> / 2 - kAssumedElevation, static_cast<float>(phi)};
}

/// Slopes and the projection of slopes onto those of a surface.
class Projection {
  public:
    [[nodiscard]] static Result<Projection> create(std::size_t rows, std::size_t cols) {
        SATEEN_TRY(Fft2d fft, Fft2d::create(rows, cols));
        return Projection(std::move(fft));
    }

    /// Replaces p and q by the derivatives of the nearest surface.
    void apply(Image& p, Image& q, Executor& executor) {
        surface(p, q, executor);
        differentiate(p, q, executor);
    }

    /// The start: the slopes of the surface that shows the image if shading is linear in
    /// them, I / ρ = l3 - l1 p - l2 q [Pentland 1989], damped where that shows little.
    void linear_start(const Image& shading, const std::array<float, 3>& l, Image& p,
                      Image& q, Executor& executor) {
        fft_.forward(shading.plane(0), Z_.view(), executor);
        const auto Z = Z_.view();
        for (std::size_t m = 0; m < fft_.rows(); ++m)
            for (std::size_t n = 0; n < fft_.spectrum_cols(); ++n) {
                const float x = omega_x(n);
                const float y = omega_y(m);
                const float along = x * l[0] + y * l[1];
                const float damping =
                    kDamping * (x * x + y * y) * (l[0] * l[0] + l[1] * l[1]);
                const float power = along * along + damping;
                const float gain = power > 0 ? along / power : 0;
                const float re = Z.re(m, n);
                Z.re(m, n) = -gain * Z.im(m, n);
                Z.im(m, n) = gain * re;
            }
        differentiate(p, q, executor);
    }

    BasicImage<double> height(const Image& p, const Image& q, Executor& executor) {
        surface(p, q, executor);
        Image z(1, fft_.rows(), fft_.cols());
        fft_.inverse(Z_.view(), z.plane(0), executor);
        BasicImage<double> out(1, fft_.rows(), fft_.cols());
        std::copy(z.values().begin(), z.values().end(), out.values().begin());
        return out;
    }

  private:
    explicit Projection(Fft2d fft)
        : fft_(std::move(fft)),
          P_(fft_.rows(), fft_.spectrum_cols()),
          Z_(fft_.rows(), fft_.spectrum_cols()) {}

    /// The derivatives of the surface in Z_.
    void differentiate(Image& p, Image& q, Executor& executor) {
        const auto z = Z_.view();
        for (const bool along_x : {true, false}) {
            const auto slope = P_.view();
            for (std::size_t m = 0; m < fft_.rows(); ++m)
                for (std::size_t n = 0; n < fft_.spectrum_cols(); ++n) {
                    const float omega = along_x ? omega_x(n) : omega_y(m);
                    slope.re(m, n) = -omega * z.im(m, n);
                    slope.im(m, n) = omega * z.re(m, n);
                }
            fft_.inverse(slope, (along_x ? p : q).plane(0), executor);
        }
    }

    // Nyquist frequencies have no odd part.
    [[nodiscard]] float omega_x(std::size_t n) const { return omega(n, fft_.cols()); }
    [[nodiscard]] float omega_y(std::size_t m) const { return -omega(m, fft_.rows()); }
    static float omega(std::size_t k, std::size_t n) {
        if (2 * k == n) return 0;
        const double turns = static_cast<double>(k) / static_cast<double>(n);
        return static_cast<float>(2 * std::numbers::pi * (2 * k > n ? turns - 1 : turns));
    }

    /// Ẑ = -j (ωx P + ωy Q) / (ωx² + ωy²), see integrate().
    void surface(const Image& p, const Image& q, Executor& executor) {
        fft_.forward(p.plane(0), P_.view(), executor);
        fft_.forward(q.plane(0), Z_.view(), executor);
        const auto P = P_.view();
        const auto Z = Z_.view();
        for (std::size_t m = 0; m < fft_.rows(); ++m)
            for (std::size_t n = 0; n < fft_.spectrum_cols(); ++n) {
                const float x = omega_x(n);
                const float y = omega_y(m);
                const float square = x * x + y * y;
                const float gain = square > 0 ? 1 / square : 0;
                const float re = x * P.re(m, n) + y * Z.re(m, n);
                const float im = x * P.im(m, n) + y * Z.im(m, n);
                Z.re(m, n) = gain * im;
                Z.im(m, n) = -gain * re;
            }
    }

    Fft2d fft_;
    SplitComplexPlane P_;
    SplitComplexPlane Z_;
};

/// The mean of the four neighbours on a torus.
float around(const Image& image, std::size_t r, std::size_t c) {
    const std::size_t rows = image.rows();
    const std::size_t cols = image.cols();
    return (image(0, r, c + 1 < cols ? c + 1 : 0) +
            image(0, r, c > 0 ? c - 1 : cols - 1) +
            image(0, r + 1 < rows ? r + 1 : 0, c) +
            image(0, r > 0 ? r - 1 : rows - 1, c)) /
           4;
}

class Shading {
  public:
    Shading(const Image& image, Direction light, double albedo)
        : image_(image), l_(to_vector(light)), albedo_(static_cast<float>(albedo)) {}

    void step(Image& p, Image& q, float smoothing, Executor& executor) const {
        const Image old_p = p;
        const Image old_q = q;
        parallel_for(executor, p.rows(), [&](std::size_t r) {
            for (std::size_t c = 0; c < p.cols(); ++c) {
                const auto mean = [&](const Image& old) {
                    return old(0, r, c) + smoothing * (around(old, r, c) - old(0, r, c));
                };
                const float p0 = mean(old_p);
                const float q0 = mean(old_q);
                const float w = std::sqrt(1 + p0 * p0 + q0 * q0);
                const float s = -l_[0] * p0 - l_[1] * q0 + l_[2];
                const float error = image_(0, r, c) / albedo_ - std::max(0.0F, s) / w;
                const float slope_p = -l_[0] / w - s * p0 / (w * w * w);
                const float slope_q = -l_[1] / w - s * q0 / (w * w * w);
                const auto bounded = [](float v) {
                    return std::clamp(v, -kSteepest, kSteepest);
                };
                p(0, r, c) = bounded(p0 + kStep * error * slope_p);
                q(0, r, c) = bounded(q0 + kStep * error * slope_q);
            }
        });
    }

    /// I / ρ.
    [[nodiscard]] Image relative() const {
        Image out = image_;
        for (float& v : out.values()) v /= albedo_;
        return out;
    }

    /// Root mean square error of the image, against its deviation.
    [[nodiscard]] double residual(const Image& p, const Image& q) const {
        const double mean = mean_of(image_);
        double error = 0;
        double deviation = 0;
        for (std::size_t i = 0; i < p.plane_size(); ++i) {
            const float p0 = p.values()[i];
            const float q0 = q.values()[i];
            const float shading = std::max(0.0F, -l_[0] * p0 - l_[1] * q0 + l_[2]) /
                                  std::sqrt(1 + p0 * p0 + q0 * q0);
            const auto value = static_cast<double>(image_.values()[i]);
            const double e = value - static_cast<double>(albedo_ * shading);
            error += e * e;
            deviation += (value - mean) * (value - mean);
        }
        return deviation > 0 ? std::sqrt(error / deviation) : 0;
    }

  private:
    const Image& image_;
    std::array<float, 3> l_;
    float albedo_;
};

/// Slopes of half the size, on twice the size.
Image doubled(const Image& coarse, std::size_t rows, std::size_t cols) {
    Image out(1, rows, cols);
    for (std::size_t r = 0; r < rows; ++r)
        for (std::size_t c = 0; c < cols; ++c) out(0, r, c) = coarse(0, r / 2, c / 2);
    return out;
}

Result<void> check(const Image& image, const ShadingOptions& options) {
    if (std::min(image.rows(), image.cols()) < kSmallestSide)
        return Error{Errc::invalid_argument, "shape from shading: an image of " +
                                                 std::to_string(image.cols()) + " x " +
                                                 std::to_string(image.rows()) +
                                                 " pixels, expected at least 16 a side"};
    if (!options.light) return {};
    const float degrees = options.light->theta / kRadiansPerDegree;
    if (degrees >= 5 && degrees <= 85) return {};
    return Error{Errc::invalid_argument,
                 "shape from shading: a light " + std::to_string(degrees) +
                     " degrees from the normal, expected 5 to 85"};
}

}  // namespace

Result<ShadingEstimate> shape_from_shading(const Image& image,
                                           const ShadingOptions& options,
                                           Executor& executor, Progress& progress) {
    SATEEN_CHECK(check(image, options));
    ShadingEstimate out;
    std::vector<Image> scales = {luminance_window(image)};
    SATEEN_CHECK(periodic_part(scales[0].plane(0), scales[0].plane(0), executor));
    out.light_estimated = !options.light;
    out.light = options.light ? *options.light : estimate_light(scales[0]);
    // E R is l3 for gentle relief, whose slopes are of mean 0.
    out.albedo = mean_of(scales[0]) / std::cos(static_cast<double>(out.light.theta));
    if (!(out.albedo > 0))
        return Error{Errc::invalid_argument, "shape from shading: a black image"};
    while (true) {
        const Image& last = scales.back();
        const std::size_t rows = last.rows() / 2;
        const std::size_t cols = last.cols() / 2;
        if (std::min(rows, cols) < kCoarsestSide || last.rows() % 2 != 0 ||
            last.cols() % 2 != 0)
            break;
        scales.push_back(halved(last));
    }

    Image p(1, scales.back().rows(), scales.back().cols());
    Image q = p;
    for (std::size_t scale = scales.size(); scale-- > 0;) {
        const Image& shown = scales[scale];
        if (p.rows() != shown.rows()) {
            p = doubled(p, shown.rows(), shown.cols());
            q = doubled(q, shown.rows(), shown.cols());
        }
        SATEEN_TRY(Projection projection, Projection::create(p.rows(), p.cols()));
        const Shading shading(shown, out.light, out.albedo);
        if (scale + 1 == scales.size())
            projection.linear_start(shading.relative(), to_vector(out.light), p, q,
                                    executor);
        for (std::size_t i = 0; i < options.iterations; ++i) {
            if (progress.cancelled())
                return Error{Errc::cancelled, "cancelled while finding the shape"};
            const float left =
                1 - static_cast<float>(i + 1) / static_cast<float>(options.iterations);
            shading.step(p, q, kSmoothing * left, executor);
            projection.apply(p, q, executor);
        }
        if (scale > 0) continue;
        out.residual = shading.residual(p, q);
        out.height_px = projection.height(p, q, executor);
    }
    return out;
}

}  // namespace sateen

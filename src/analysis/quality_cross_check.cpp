// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <span>
#include <vector>

#include "analysis/quality_parts.hpp"
#include "sateen/analysis/quality.hpp"
#include "sateen/core/normal.hpp"

namespace sateen {
namespace {

constexpr std::size_t kScales = 3;

// Means of 2 x 2 pixels.
Image half_size(const Image& image) {
    Image out(1, image.rows() / 2, image.cols() / 2);
    for (std::size_t r = 0; r < out.rows(); ++r) {
        for (std::size_t c = 0; c < out.cols(); ++c) {
            out(0, r, c) =
                0.25F * (image(0, 2 * r, 2 * c) + image(0, 2 * r, 2 * c + 1) +
                         image(0, 2 * r + 1, 2 * c) + image(0, 2 * r + 1, 2 * c + 1));
        }
    }
    return out;
}

std::vector<Image> scales_of(Image lightness) {
    std::vector<Image> scales;
    scales.push_back(std::move(lightness));
    while (scales.size() < kScales) scales.push_back(half_size(scales.back()));
    return scales;
}

// Log kurtosis of differences of neighbours `down` rows and `across` columns apart.
double log_gradient_kurtosis(const Image& image, std::size_t down, std::size_t across) {
    double square = 0;
    double fourth = 0;
    double count = 0;
    for (std::size_t r = 0; r + down < image.rows(); ++r) {
        for (std::size_t c = 0; c + across < image.cols(); ++c) {
            const double d = static_cast<double>(image(0, r + down, c + across)) -
                             static_cast<double>(image(0, r, c));
            square += d * d;
            fourth += d * d * d * d;
            count += 1;
        }
    }
    // As if invisible Gaussian noise had been added: a constant image has the kurtosis 3.
    constexpr double kNoise = quality::kInvisible * quality::kInvisible;
    square /= count;
    fourth /= count;
    const double variance = square + kNoise;
    return std::log((fourth + 6 * kNoise * square + 3 * kNoise * kNoise) /
                    (variance * variance));
}

double gradient_kurtosis_distance(const std::vector<Image>& a,
                                  const std::vector<Image>& b) {
    double sum = 0;
    for (std::size_t s = 0; s < kScales; ++s) {
        sum += std::abs(log_gradient_kurtosis(a[s], 0, 1) -
                        log_gradient_kurtosis(b[s], 0, 1));
        sum += std::abs(log_gradient_kurtosis(a[s], 1, 0) -
                        log_gradient_kurtosis(b[s], 1, 0));
    }
    return sum / (2 * kScales);
}

/// Sets of connected pixels, by union-find with path halving.
class Components {
  public:
    explicit Components(std::size_t count) : parent_(count) {
        std::iota(parent_.begin(), parent_.end(), std::size_t{0});
    }
    std::size_t find(std::size_t i) {
        while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
        return i;
    }
    void join(std::size_t i, std::size_t j) { parent_[find(i)] = find(j); }

  private:
    std::vector<std::size_t> parent_;
};

constexpr std::size_t kOctaves = 48;
using AreaHistogram = std::array<double, kOctaves>;

// Share of the marked pixels that lie in 4-connected blobs of 2^k … 2^(k+1) - 1 pixels.
AreaHistogram blob_areas(const Image& image, float threshold, bool brighter) {
    const std::size_t rows = image.rows();
    const std::size_t cols = image.cols();
    const auto marked = [&](std::size_t r, std::size_t c) {
        return brighter ? image(0, r, c) >= threshold : image(0, r, c) <= threshold;
    };
    Components components(rows * cols);
    for (std::size_t r = 0; r < rows; ++r) {
        for (std::size_t c = 0; c < cols; ++c) {
            if (!marked(r, c)) continue;
            const std::size_t i = r * cols + c;
            if (r > 0 && marked(r - 1, c)) components.join(i, i - cols);
            if (c > 0 && marked(r, c - 1)) components.join(i, i - 1);
        }
    }
    std::vector<std::uint32_t> area(rows * cols);
    double total = 0;
    for (std::size_t r = 0; r < rows; ++r) {
        for (std::size_t c = 0; c < cols; ++c) {
            if (!marked(r, c)) continue;
            ++area[components.find(r * cols + c)];
            total += 1;
        }
    }
    AreaHistogram histogram{};
    for (std::uint32_t a : area) {
        if (a == 0) continue;
        histogram[static_cast<std::size_t>(std::log2(static_cast<double>(a)))] +=
            a / total;
    }
    return histogram;
}

float quantile(const Image& image, double probability) {
    std::vector<float> values(image.values().begin(), image.values().end());
    const auto nth =
        values.begin() +
        static_cast<std::ptrdiff_t>(probability * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), nth, values.end());
    return *nth;
}

// 1-Wasserstein distance in octaves.
double distance(const AreaHistogram& a, const AreaHistogram& b) {
    double below = 0;
    double sum = 0;
    for (std::size_t k = 0; k < kOctaves; ++k) {
        below += a[k] - b[k];
        sum += std::abs(below);
    }
    return sum;
}

double blob_distance(const Image& a, const Image& b) {
    constexpr double kShare = 0.2;
    const double dark = distance(blob_areas(a, quantile(a, kShare), false),
                                 blob_areas(b, quantile(b, kShare), false));
    const double bright = distance(blob_areas(a, quantile(a, 1 - kShare), true),
                                   blob_areas(b, quantile(b, 1 - kShare), true));
    return (dark + bright) / 2;
}

constexpr std::size_t kPatch = 5;
using PatchFilter = std::array<float, kPatch * kPatch>;

// A random direction among mean-free patches, of unit length.
PatchFilter random_filter(std::uint32_t index) {
    PatchFilter filter{};
    draw_normals({0, index}, 0, 0, filter);
    const float mean =
        std::accumulate(filter.begin(), filter.end(), 0.0F) / float{kPatch * kPatch};
    float square = 0;
    for (float& w : filter) {
        w -= mean;
        square += w * w;
    }
    for (float& w : filter) w /= std::sqrt(square);
    return filter;
}

constexpr std::size_t kPatchQuantiles = 128;

// Quantiles of a filter's responses, at most about 2^14 of them, evenly spread.
std::array<double, kPatchQuantiles> response_quantiles(const Image& image,
                                                       const PatchFilter& filter) {
    constexpr double kMost = 16384;
    const std::size_t rows = image.rows() - kPatch + 1;
    const std::size_t cols = image.cols() - kPatch + 1;
    const auto step = std::max<std::size_t>(
        1, static_cast<std::size_t>(std::sqrt(static_cast<double>(rows * cols) / kMost)));
    std::vector<float> responses;
    for (std::size_t r = 0; r < rows; r += step) {
        for (std::size_t c = 0; c < cols; c += step) {
            float sum = 0;
            for (std::size_t i = 0; i < kPatch; ++i) {
                const float* x = image.plane(0).row(r + i) + c;
                for (std::size_t j = 0; j < kPatch; ++j)
                    sum += filter[i * kPatch + j] * x[j];
            }
            responses.push_back(sum);
        }
    }
    std::sort(responses.begin(), responses.end());
    std::array<double, kPatchQuantiles> quantiles{};
    for (std::size_t q = 0; q < kPatchQuantiles; ++q) {
        const double at = (static_cast<double>(q) + 0.5) / kPatchQuantiles *
                          static_cast<double>(responses.size() - 1);
        const auto below = static_cast<std::size_t>(at);
        const std::size_t above = std::min(below + 1, responses.size() - 1);
        const double t = at - static_cast<double>(below);
        quantiles[q] = (1 - t) * static_cast<double>(responses[below]) +
                       t * static_cast<double>(responses[above]);
    }
    return quantiles;
}

double patch_distance(const std::vector<Image>& a, const std::vector<Image>& b) {
    constexpr std::uint32_t kFilters = 32;
    double sum = 0;
    for (std::size_t s = 0; s < kScales; ++s) {
        double square = 0;
        for (std::uint32_t k = 0; k < kFilters; ++k) {
            const PatchFilter filter = random_filter(k);
            const auto qa = response_quantiles(a[s], filter);
            const auto qb = response_quantiles(b[s], filter);
            for (std::size_t q = 0; q < kPatchQuantiles; ++q) {
                square += (qa[q] - qb[q]) * (qa[q] - qb[q]);
            }
        }
        sum += std::sqrt(square / (kFilters * kPatchQuantiles));
    }
    return sum / kScales;
}

double deviation_of(const Image& image) {
    const auto n = static_cast<double>(image.plane_size());
    const double mean =
        std::accumulate(image.values().begin(), image.values().end(), 0.0) / n;
    double square = 0;
    for (float v : image.values())
        square += (static_cast<double>(v) - mean) * (static_cast<double>(v) - mean);
    return std::sqrt(square / n);
}

double ratio_or_one(double across, double inside) {
    if (inside > 0) return across / inside;
    return across > 0 ? std::numeric_limits<double>::max() : 1;
}

}  // namespace

Result<TextureCrossCheck> cross_check(const Image& reference, const Image& candidate) {
    SATEEN_CHECK(quality::check_image(reference, "reference"));
    SATEEN_CHECK(quality::check_image(candidate, "candidate"));
    const float exposure = quality::choose_exposure(reference);
    const auto a = scales_of(quality::to_lightness(reference, exposure));
    const auto b = scales_of(quality::to_lightness(candidate, exposure));
    const double unit = std::hypot(deviation_of(a.front()), quality::kInvisible);
    return TextureCrossCheck{gradient_kurtosis_distance(a, b),
                             blob_distance(a.front(), b.front()),
                             patch_distance(a, b) / unit};
}

SeamRatio seam_ratio(ImageView<const float> image) {
    const std::size_t rows = image.rows;
    const std::size_t cols = image.cols;
    double inside_rows = 0;
    double inside_cols = 0;
    double across_rows = 0;
    double across_cols = 0;
    for (std::size_t b = 0; b < image.bands; ++b) {
        const auto plane = image.plane(b);
        const auto gap = [&plane](std::size_t r, std::size_t c, std::size_t r2,
                                  std::size_t c2) {
            return std::abs(static_cast<double>(plane(r, c)) -
                            static_cast<double>(plane(r2, c2)));
        };
        for (std::size_t r = 0; r < rows; ++r) {
            for (std::size_t c = 0; c < cols; ++c) {
                (r + 1 < rows ? inside_rows : across_rows) +=
                    gap(r, c, (r + 1) % rows, c);
                (c + 1 < cols ? inside_cols : across_cols) +=
                    gap(r, c, r, (c + 1) % cols);
            }
        }
    }
    const auto neighbours = [](std::size_t side) {
        return static_cast<double>(std::max<std::size_t>(side, 2) - 1);
    };
    return {ratio_or_one(across_rows, inside_rows / neighbours(rows)),
            ratio_or_one(across_cols, inside_cols / neighbours(cols))};
}

}  // namespace sateen

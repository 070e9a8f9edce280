// SPDX-License-Identifier: Apache-2.0
// Interpolation over views and lights. See interpolate.hpp.
#include "sateen/synthesis/interpolate.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "sateen/core/colour.hpp"
#include "synthesis/blend_batch.hpp"

namespace sateen {
namespace {

constexpr std::array<float, 3> kLuminance = {
    static_cast<float>(kRelativeXyzOfLinearSrgb[1][0]),
    static_cast<float>(kRelativeXyzOfLinearSrgb[1][1]),
    static_cast<float>(kRelativeXyzOfLinearSrgb[1][2])};

float luminance(const std::array<float, 3>& colour, std::size_t bands) {
    if (bands == 1) return colour[0];
    return kLuminance[0] * colour[0] + kLuminance[1] * colour[1] +
           kLuminance[2] * colour[2];
}

float dot(const std::array<float, 3>& a, const std::array<float, 3>& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

// -8 ln E[√(x / mean)]
double root_shape(double mean, double root_mean) {
    if (!(mean > 0) || !(root_mean > 0)) return 0;
    return std::max(0.0, -8 * std::log(root_mean / std::sqrt(mean)));
}

// The subspace of every pair, (lights, views); see DirectionalInterpolation::index.
std::vector<std::uint8_t> full_index(const Material& material) {
    constexpr std::uint8_t kUnmeasured = 255;
    const std::size_t L = material.lights.size();
    const std::size_t V = material.views.size();
    std::vector<std::uint8_t> measured(L * V, kUnmeasured);
    std::vector<std::vector<std::uint16_t>> views_of(L);
    for (const IndexEntry& entry : material.index) {
        measured[entry.light * V + entry.view] = entry.subspace;
        views_of[entry.light].push_back(entry.view);
    }
    std::vector<std::uint8_t> index = measured;
    if (material.index.size() == L * V) return index;
    std::vector<std::array<float, 3>> views;
    std::vector<std::array<float, 3>> lights;
    for (const Direction d : material.views) views.push_back(to_vector(d));
    for (const Direction d : material.lights) lights.push_back(to_vector(d));
    std::vector<std::size_t> nearest(L);
    for (std::size_t l = 0; l < L; ++l) {
        // Lights by their distance: no view makes up for one that is too far.
        std::iota(nearest.begin(), nearest.end(), std::size_t{0});
        std::stable_sort(nearest.begin(), nearest.end(), [&](auto a, auto b) {
            return dot(lights[a], lights[l]) > dot(lights[b], lights[l]);
        });
        for (std::size_t v = 0; v < V; ++v) {
            if (measured[l * V + v] != kUnmeasured) continue;
            float best = -3;
            for (const std::size_t other : nearest) {
                const float closeness = dot(lights[other], lights[l]);
                if (closeness + 1 <= best) break;
                for (const std::uint16_t view : views_of[other]) {
                    const float sum = closeness + dot(views[view], views[v]);
                    if (sum <= best) continue;
                    best = sum;
                    index[l * V + v] = measured[other * V + view];
                }
            }
        }
    }
    return index;
}

void find_weights(const DirectionMesh& mesh, const DirectionTable& table,
                  bool three_nearest, const VectorBatch& directions, std::size_t count,
                  WeightBatch& out) {
    if (!three_nearest && !mesh.cells().empty() &&
        interpolate_batch(table, directions, count, out))
        return;
    for (std::size_t i = 0; i < count; ++i) {
        const std::array<float, 3> d = {directions[0][i], directions[1][i],
                                        directions[2][i]};
        const DirectionWeights found =
            three_nearest ? mesh.nearest_three(d) : mesh.interpolate(d);
        for (std::size_t k = 0; k < 3; ++k) {
            out.index[k][i] = found.index[k];
            out.weight[k][i] = found.weight[k];
        }
    }
    // Vectors reach past the last.
    for (std::size_t k = 0; k < 3; ++k)
        for (std::size_t i = count; i < kBatch; ++i) {
            out.index[k][i] = out.index[k][count - 1];
            out.weight[k][i] = out.weight[k][count - 1];
        }
}

}  // namespace

TextureMoments texture_moments(std::span<const Image> textures) {
    TextureMoments moments;
    const std::size_t n = textures.size();
    moments.mean.resize(n);
    moments.shape.resize(n);
    moments.covariance.resize(n * n);
    if (n == 0) return moments;
    const std::size_t pixels = textures[0].plane_size();
    const std::size_t bands = textures[0].bands();
    std::vector<std::vector<float>> deviations(n);
    for (std::size_t k = 0; k < n; ++k) {
        for (std::size_t b = 0; b < bands; ++b) {
            const auto plane = textures[k].plane(b);
            const double sum = std::accumulate(plane.data, plane.data + pixels, 0.0);
            moments.mean[k][b] = static_cast<float>(sum / static_cast<double>(pixels));
        }
        const float mean = luminance(moments.mean[k], bands);
        deviations[k].resize(pixels);
        std::array<double, 4> roots{};
        for (std::size_t i = 0; i < pixels; ++i) {
            std::array<float, 3> colour{};
            for (std::size_t b = 0; b < bands; ++b) {
                colour[b] = textures[k].plane(b).data[i];
                roots[b] += static_cast<double>(std::sqrt(colour[b]));
            }
            const float Y = luminance(colour, bands);
            roots[3] += static_cast<double>(std::sqrt(Y));
            deviations[k][i] = Y - mean;
        }
        const auto root = [&](float of, double sum) {
            return root_shape(static_cast<double>(of), sum / static_cast<double>(pixels));
        };
        const double variance =
            std::inner_product(deviations[k].begin(), deviations[k].end(),
                               deviations[k].begin(), 0.0) /
            static_cast<double>(pixels);
        const auto Y = static_cast<double>(mean);
        const double C = Y > 0 ? std::log1p(variance / (Y * Y)) : 0.0;
        const double h = root(mean, roots[3]);
        moments.shape[k] = {1, 1, 1, 0};
        // Of nearly uniform textures it is rounding.
        if (!(C > 1e-5)) continue;
        for (std::size_t b = 0; b < bands; ++b)
            moments.shape[k][b] =
                static_cast<float>(root(moments.mean[k][b], roots[b]) / h);
        moments.shape[k][3] = static_cast<float>((h - C) / (C * C));
    }
    for (std::size_t j = 0; j < n; ++j)
        for (std::size_t k = 0; k <= j; ++k) {
            const double sum = std::inner_product(
                deviations[j].begin(), deviations[j].end(), deviations[k].begin(), 0.0);
            moments.covariance[j * n + k] = moments.covariance[k * n + j] =
                static_cast<float>(sum / static_cast<double>(pixels));
        }
    return moments;
}

Result<DirectionalInterpolation> DirectionalInterpolation::create(
    const Material& material, TextureMoments moments,
    const InterpolationOptions& options) {
    DirectionalInterpolation out;
    out.options_ = options;
    if (material.index.empty()) return out;
    SATEEN_TRY(out.views_, DirectionMesh::create(material.views));
    SATEEN_TRY(out.lights_, DirectionMesh::create(material.lights));
    if (material.lights.size() * material.views.size() > kMaxPairs)
        return Error{Errc::limit_exceeded, std::to_string(material.lights.size()) +
                                               " lights and " +
                                               std::to_string(material.views.size()) +
                                               " views: more pairs to interpolate than " +
                                               std::to_string(kMaxPairs)};
    BlendTables tables;
    tables.views = direction_table(*out.views_);
    tables.lights = direction_table(*out.lights_);
    tables.view_count = material.views.size();
    out.index_ = full_index(material);
    tables.subspace.assign(out.index_.begin(), out.index_.end());
    tables.bands = material.bands;
    tables.cosine_included = material.cosine_included;
    for (const Direction light : material.lights) {
        const float height = to_vector(light)[2];
        tables.cosine.push_back(height);
        tables.cosine_root.push_back(std::cbrt(height));
    }
    if (options.reflectance && material.reflectance)
        for (std::size_t l = 0; l < material.lights.size(); ++l)
            for (std::size_t v = 0; v < material.views.size(); ++v)
                tables.encoded.push_back(encoded_appearance(*material.reflectance, v, l));
    const std::size_t n = moments.mean.size();
    tables.rows.resize(n);
    for (std::size_t k = 0; k < n; ++k) {
        auto& row = tables.rows[k];
        const float Y = luminance(moments.mean[k], material.bands);
        for (std::size_t j = 0; j < n; ++j)
            row[BlendTables::kCovariance + j] = moments.covariance[k * n + j];
        for (std::size_t b = 0; b < 3; ++b)
            row[BlendTables::kMean + b] = moments.mean[k][b];
        row[BlendTables::kMean + 3] = Y;
        for (std::size_t c = 0; c < 4; ++c)
            row[BlendTables::kShape + c] = Y * moments.shape[k][c];
    }
    out.tables_ = std::make_shared<const BlendTables>(std::move(tables));
    return out;
}

void DirectionalInterpolation::at(const DirectionBatch& directions,
                                  const FactorBatch& factors, BlendBatch& out) const {
    const std::size_t count = directions.count;
    const auto nothing = [&](std::size_t i, float gain) {
        out.count[i] = 1;
        out.subspace[i] = {};
        out.weight[i] = {1};
        for (std::size_t c = 0; c < 3; ++c) {
            out.gain[c][i] = gain;
            out.offset[c][i] = 0;
        }
        out.power[i] = 1;
    };
    if (tables_) {
        WeightBatch views;
        WeightBatch lights;
        const bool nearest = options_.three_nearest;
        find_weights(*views_, tables_->views, nearest, directions.view, count, views);
        find_weights(*lights_, tables_->lights, nearest, directions.light, count, lights);
        blend_batch(*tables_, views, lights, directions.light[2], factors, count, out);
    }
    for (std::size_t i = 0; i < count; ++i) {
        const float height = directions.light[2][i];
        if (height <= 0 || directions.view[2][i] <= 0)
            nothing(i, 0);
        else if (!tables_)
            // Of photographs the light is unknown: their values are taken for reflectance.
            nothing(i, height);
    }
}

Blend DirectionalInterpolation::at(const std::array<float, 3>& view,
                                   const std::array<float, 3>& light,
                                   const FactorShape& factor) const {
    DirectionBatch directions;
    FactorBatch factors;
    directions.count = 1;
    for (std::size_t c = 0; c < 3; ++c) {
        directions.view[c].fill(view[c]);
        directions.light[c].fill(light[c]);
    }
    factors.square.fill(factor.square);
    factors.root.fill(factor.root);
    BlendBatch batch;
    at(directions, factors, batch);
    Blend blend;
    blend.count = batch.count[0];
    blend.subspace = batch.subspace[0];
    blend.weight = batch.weight[0];
    for (std::size_t c = 0; c < 3; ++c) {
        blend.gain[c] = batch.gain[c][0];
        blend.offset[c] = batch.offset[c][0];
    }
    blend.power = batch.power[0];
    return blend;
}

}  // namespace sateen

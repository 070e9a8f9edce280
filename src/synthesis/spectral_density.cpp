// SPDX-License-Identifier: Apache-2.0
// Spectral densities on a torus. See spectral_density.hpp.
#include "synthesis/spectral_density.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

// With static dispatch (WebAssembly) only the compiler's own target is built.
#ifdef SATEEN_STATIC_DISPATCH
#define HWY_COMPILE_ONLY_STATIC
#endif
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "synthesis/spectral_density.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#ifndef SATEEN_SYNTHESIS_SPECTRAL_DENSITY_ONCE
#define SATEEN_SYNTHESIS_SPECTRAL_DENSITY_ONCE
namespace sateen {

/// A row of a coarser level, of which the half spectrum has `cols` of `size` columns.
struct CoarseRow {
    const float* direct;
    const float* mirrored;  ///< the row at -ω1
    float mirror_sign;      ///< +1 for elements with E(-ω) = E(ω), else -1
    std::size_t cols;
    std::size_t size;
};

}  // namespace sateen
#endif

HWY_BEFORE_NAMESPACE();
namespace sateen::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

// out_n = gain col_gain_n E_n with the coarse row forwards, backwards by symmetry, and its
// first column again; zeros up to padded_columns(). Reads and writes whole vectors.
void expand_row(const CoarseRow& row, float gain, const float* col_gain, float* out) {
    const hn::ScalableTag<float> d;
    const std::size_t lanes = hn::Lanes(d);
    const CoarseRow coarse = row;  // nothing that is written is part of a copy
    float* const end = out + padded_columns(coarse.size + 1);
    for (float* at = end - padded_columns(1); at < end; at += lanes)
        hn::StoreU(hn::Zero(d), d, at);
    const auto row_gain = hn::Set(d, gain);
    for (std::size_t n = 0; n < coarse.cols; n += lanes)
        hn::StoreU(hn::Mul(hn::Mul(row_gain, hn::LoadU(d, col_gain + n)),
                           hn::LoadU(d, coarse.direct + n)),
                   d, out + n);
    const float mirrored_gain = gain * coarse.mirror_sign;
    const auto sign_gain = hn::Set(d, mirrored_gain);
    std::size_t n = coarse.cols;
    for (; n + lanes <= coarse.size; n += lanes) {
        const float* from = coarse.mirrored + (coarse.size - n - lanes + 1);
        hn::StoreU(hn::Mul(hn::Mul(sign_gain, hn::LoadU(d, col_gain + n)),
                           hn::Reverse(d, hn::LoadU(d, from))),
                   d, out + n);
    }
    for (; n < coarse.size; ++n)
        out[n] = mirrored_gain * col_gain[n] * coarse.mirrored[coarse.size - n];
    out[coarse.size] = gain * col_gain[coarse.size] * coarse.direct[0];
}

}  // namespace
}  // namespace sateen::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sateen {
namespace {

HWY_EXPORT(expand_row);

/// 2 W²(ω) along one axis: the product over both axes is 4 W².
std::vector<float> expansion_gain(std::size_t count, const Frequencies& frequencies) {
    std::vector<float> gain(padded_columns(count));
    for (std::size_t k = 0; k < count; ++k) {
        const double squared = (1 + frequencies[k].real()) / 2;  // cos² ω/2
        gain[k] = static_cast<float>(2 * squared * squared * squared * squared);
    }
    return gain;
}

/// Where on its own grid a coarser level has the frequency 2ω: an even size halves, an
/// odd one stays and is stepped through twice as fast.
struct CoarseAxis {
    std::size_t size;
    std::size_t step;
    explicit CoarseAxis(std::size_t fine)
        : size(fine % 2 == 0 ? fine / 2 : fine), step(fine % 2 == 0 ? 1 : 2) {}
    [[nodiscard]] std::size_t index(std::size_t k) const { return k * step % size; }
};

/// expand_row() for an odd number of columns.
void expand_odd_row(const CoarseRow& coarse, float gain, const float* col_gain,
                    float* out) {
    const CoarseAxis axis(coarse.size);
    for (std::size_t n = 0; n < coarse.cols; ++n) {
        const std::size_t col = axis.index(n);
        out[n] =
            gain * col_gain[n] *
            (col < coarse.cols ? coarse.direct[col]
                               : coarse.mirror_sign * coarse.mirrored[coarse.size - col]);
    }
}

}  // namespace

std::vector<PlaneField> independent_fields(const Material& material,
                                           const Subspace& subspace) {
    const std::size_t d = subspace.marginals.size();
    const bool joint = std::any_of(
        subspace.levels.begin(), subspace.levels.end(),
        [](const Level& level) { return planes_of(level.fields.front()) > 1; });
    const PlaneField first{subspace.levels, 0, static_cast<double>(material.sample_rows),
                           static_cast<double>(material.sample_cols), joint ? d : 1};
    std::vector<PlaneField> fields(joint ? 1 : d, first);
    for (std::size_t plane = 0; plane < fields.size(); ++plane)
        fields[plane].plane = plane;
    return fields;
}

SpectralDensity::SpectralDensity(const PlaneField& field, std::size_t rows,
                                 std::size_t cols, Executor& executor)
    : SpectralDensity(field, rows, cols, Coarser::streamed, executor) {}

// Rows of the finest level need each pair of rows of the next one once, in succession, so that
// these are made when their turn comes and do not leave the cache. What is coarser than that is small.
SpectralDensity::SpectralDensity(const PlaneField& field, std::size_t rows,
                                 std::size_t cols, Coarser coarser, Executor& executor)
    : rows_(rows),
      cols_(cols),
      finest_(field.levels.front().fields, field.plane, field.planes, rows_, cols_),
      planes_(field.planes) {
    if (field.levels.size() == 1) return;
    row_gain_ = expansion_gain(rows, rows_);
    col_gain_ = expansion_gain(cols / 2 + 1, cols_);
    const std::size_t coarse_rows = CoarseAxis(rows).size;
    const std::size_t coarse_cols = CoarseAxis(cols).size;
    coarser_.reset(new SpectralDensity(field.coarser(1), coarse_rows, coarse_cols,
                                       Coarser::held, executor));
    if (coarser == Coarser::streamed) return;
    coarse_ = Image(coarse_rows, planes_ * planes_, padded_columns(coarse_cols / 2 + 1),
                    uninitialised);
    parallel_for(executor, coarse_rows / 2 + 1, [&](std::size_t m) {
        const std::size_t mirrored_row = coarser_->mirror(m);
        HermitianRows<float> out{};
        HermitianRows<float> mirrored{};
        for (std::size_t k = 0; k < coarse_.rows(); ++k) {
            out[k] = coarse_.plane(m).row(k);
            if (mirrored_row != m) mirrored[k] = coarse_.plane(mirrored_row).row(k);
        }
        DensityScratch unused = coarser_->scratch();
        coarser_->rows(m, out, mirrored, unused);
    });
}

DensityScratch SpectralDensity::scratch() const {
    const bool streams = coarser_ && coarse_.empty();
    return {planes_, cols_.size() / 2 + 1, streams ? coarser_->cols_.size() / 2 + 1 : 0};
}

SpectralDensity::CoarseRows SpectralDensity::coarse_rows(std::size_t m,
                                                         DensityScratch& scratch) const {
    const std::size_t row = CoarseAxis(rows_.size()).index(m);
    const std::size_t mirrored = coarser_->mirror(row);
    CoarseRows result{};
    if (!coarse_.empty()) {
        for (std::size_t k = 0; k < coarse_.rows(); ++k) {
            result.direct[k] = coarse_.plane(row).row(k);
            result.mirrored[k] = coarse_.plane(mirrored).row(k);
        }
        return result;
    }
    // Of a row and its mirror image always the same one is evaluated, for the same bits.
    const std::size_t first = std::min(row, mirrored);
    const bool both = row != mirrored;
    if (scratch.coarse_row_ != first) {
        DensityScratch unused(0, 0, 0);
        coarser_->rows(first, scratch.coarse_,
                       both ? scratch.coarse_mirrored_ : HermitianRows<float>{}, unused);
        scratch.coarse_row_ = first;
    }
    result.direct = readable(scratch.coarse_);
    result.mirrored = readable(both ? scratch.coarse_mirrored_ : scratch.coarse_);
    if (first != row) std::swap(result.direct, result.mirrored);
    return result;
}

void SpectralDensity::rows(std::size_t m, const HermitianRows<float>& out,
                           const HermitianRows<float>& mirrored,
                           DensityScratch& scratch) const {
    start_row(m, out, scratch);
    if (mirrored[0] != nullptr) start_row(mirror(m), mirrored, scratch);
    finest_.add_rows(m, out, mirrored);
}

void SpectralDensity::start_row(std::size_t m, const HermitianRows<float>& out,
                                DensityScratch& scratch) const {
    const std::size_t count = cols_.size() / 2 + 1;
    const std::size_t elements = planes_ * planes_;
    const CoarseAxis axis(cols_.size());
    for (std::size_t k = 0; k < elements && (!coarser_ || axis.step != 1); ++k)
        std::fill_n(out[k], padded_columns(count), 0.0F);
    if (!coarser_) return;
    const CoarseRows coarse = coarse_rows(m, scratch);
    const auto expand =
        axis.step == 1 ? HWY_DYNAMIC_DISPATCH(expand_row) : &expand_odd_row;
    for (std::size_t k = 0; k < elements; ++k)
        expand({coarse.direct[k], coarse.mirrored[k],
                k / planes_ > k % planes_ ? -1.0F : 1.0F, axis.size / 2 + 1, axis.size},
               row_gain_[m], col_gain_.data(), out[k]);
}

std::vector<std::size_t> rows_in_step(std::size_t rows) {
    std::vector<std::size_t> order;
    const std::size_t half = rows / 2;
    for (std::size_t m = 0; rows % 2 == 0 && m <= half / 2; ++m) {
        order.push_back(m);
        if (2 * m != half) order.push_back(half - m);
    }
    for (std::size_t m = order.size(); m <= half; ++m) order.push_back(m);
    return order;
}

DensityScratch::DensityScratch(std::size_t planes, std::size_t count,
                               std::size_t coarse_count)
    : values_(2, planes * planes, padded_columns(count), uninitialised),
      coarse_values_(2, planes * planes, padded_columns(coarse_count), uninitialised) {
    for (std::size_t k = 0; k < values_.rows(); ++k) {
        rows_[k] = values_.plane(0).row(k);
        mirrored_[k] = values_.plane(1).row(k);
        coarse_[k] = coarse_values_.plane(0).row(k);
        coarse_mirrored_[k] = coarse_values_.plane(1).row(k);
    }
}

Image spectral_density(const PlaneField& field, std::size_t rows, std::size_t cols,
                       Executor& executor) {
    const SpectralDensity density(field, rows, cols, executor);
    Image whole(field.planes * field.planes, rows, cols / 2 + 1, uninitialised);
    density.for_each_row(executor, [&](std::size_t m, const HermitianRows<float>& E) {
        for (std::size_t k = 0; k < whole.bands(); ++k)
            std::copy_n(E[k], whole.cols(), whole.plane(k).row(m));
    });
    return whole;
}

void suppress_unmeasured(const PlaneField& field, PlaneView<float> density,
                         std::size_t cols) {
    for (std::size_t m = 0; m < density.rows; ++m)
        suppress_unmeasured(field, m, density.rows, cols, {density.row(m), density.cols});
}

void suppress_unmeasured(const PlaneField& field, std::size_t m, std::size_t rows,
                         std::size_t cols, std::span<float> density) {
    const auto closeness = [](std::size_t k, std::size_t size, double sample) {
        const auto cycles = static_cast<double>(std::min(k, size - k));
        return std::max(0.0, 1 - cycles * sample / static_cast<double>(size));
    };
    const double row = closeness(m, rows, field.sample_rows);
    if (row == 0) return;
    for (std::size_t n = 0; n < density.size(); ++n) {
        const double col = closeness(n, cols, field.sample_cols);
        if (col == 0) break;
        density[n] *= static_cast<float>(1 - row * col);
    }
}

double mean_density(PlaneView<const float> density, std::size_t cols) {
    double sum = 0;
    for (std::size_t m = 0; m < density.rows; ++m) {
        const float* row = density.row(m);
        double both = 0;
        for (std::size_t n = 0; n < density.cols; ++n)
            both += static_cast<double>(row[n]);
        sum += 2 * both - static_cast<double>(row[0]);
        if (cols % 2 == 0) sum -= static_cast<double>(row[density.cols - 1]);
    }
    return sum / static_cast<double>(density.rows * cols);
}

}  // namespace sateen
#endif

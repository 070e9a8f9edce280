// SPDX-License-Identifier: Apache-2.0
// Textures on a torus. See torus.hpp.
#include "synthesis/torus.hpp"

#include <algorithm>

#include "synthesis/noise_bands.hpp"
#include "synthesis/spectral_density.hpp"
#include "synthesis/toroidal_field.hpp"

namespace sateen {

bool fits_one_transform(const SynthesisOptions& options) {
    return is_fft_size(options.rows) && is_fft_size(options.cols) &&
           options.rows * options.cols <= kWholeTextureSites;
}

Result<Torus> Torus::create(const Material& material, const SynthesisOptions& options) {
    SATEEN_TRY(Fft2d fft, Fft2d::create(options.rows, options.cols));
    return Torus(std::move(fft), material, options.seed);
}

std::vector<SplitComplexPlane> Torus::noise(Executor& executor) const {
    std::vector<SplitComplexPlane> spectra = this->spectra();
    for (std::uint32_t plane = 0; plane < spectra.size(); ++plane)
        draw_noise_spectrum({seed_, noise_band(plane)}, fft_.cols(),
                            spectra[plane].view(), executor);
    return spectra;
}

std::vector<SplitComplexPlane> Torus::spectra() const {
    std::vector<SplitComplexPlane> spectra;
    for (std::size_t plane = 0; plane < material_->bands; ++plane)
        spectra.emplace_back(fft_.rows(), fft_.spectrum_cols(), uninitialised);
    return spectra;
}

/// Rows are transformed back and finished while they are in the cache.
/// \param finish  finish(row, planes, out) of every block of rows
template <class FinishRows>
Image Torus::draw_rows(const Subspace& subspace, std::span<const SplitComplexPlane> noise,
                       const FinishRows& finish, Executor& executor) const {
    std::vector<SplitComplexPlane> coloured = spectra();
    std::vector<float> gains;
    for (const PlaneField& field : independent_fields(*material_, subspace)) {
        const auto of_field = colour_noise(
            field, fft_.cols(), {seed_, noise},
            std::span(coloured).subspan(field.plane, field.planes), executor);
        gains.insert(gains.end(), of_field.begin(), of_field.begin() + field.planes);
    }
    for (SplitComplexPlane& plane : coloured)
        fft_.inverse_columns(plane.view(), executor);
    Image texture(coloured.size(), fft_.rows(), fft_.cols(), uninitialised);
    const auto invert = [&](std::size_t first, std::size_t count,
                            Fft2d::Scratch& scratch) {
        SerialExecutor serial;
        const std::size_t floats = coloured.size() * count * fft_.cols();
        const ImageView<float> rows(scratch.floats(floats), coloured.size(), count,
                                    fft_.cols());
        for (std::size_t plane = 0; plane < coloured.size(); ++plane) {
            const SplitComplexPlane& spectrum = coloured[plane];
            fft_.inverse_rows(spectrum.view(), first, gains[plane], rows.plane(plane),
                              scratch);
        }
        finish(static_cast<std::int32_t>(first), rows,
               windows_of(texture.view(), first, count), serial);
    };
    fft_.for_row_blocks(executor, invert);
    return texture;
}

Image Torus::draw(const Subspace& subspace, const Finish& finish,
                  std::span<const SplitComplexPlane> noise, Executor& executor) const {
    if (finish.margin() == 0) {
        const auto finish_rows = [&](std::int32_t row, ImageView<float> planes,
                                     std::span<const PlaneView<float>> out,
                                     Executor& serial) {
            finish(subspace, row, 0, planes, out, serial);
        };
        return draw_rows(subspace, noise, finish_rows, executor);
    }
    // Bands reach over all blocks of rows.
    const auto keep = [](std::int32_t, ImageView<float> planes,
                         std::span<const PlaneView<float>> out, Executor&) {
        for (std::size_t plane = 0; plane < planes.bands; ++plane)
            std::copy_n(planes.plane(plane).data, planes.plane_size(), out[plane].data);
    };
    Image texture = draw_rows(subspace, noise, keep, executor);
    finish.modulate(subspace, Border::wrap, 0, 0, texture.view(), executor);
    finish(subspace, 0, 0, texture.view(), executor);
    return texture;
}

}  // namespace sateen

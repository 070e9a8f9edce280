// SPDX-License-Identifier: Apache-2.0
// From drawn fields to reflectance. See finish.hpp.
#include "synthesis/finish.hpp"

#include <algorithm>

#include "synthesis/appearance.hpp"

namespace sateen {
namespace {

/// A plane that is constant stays as it is.
void divide(ImageView<float> planes, const std::vector<float>& deviations) {
    for (std::size_t plane = 0; plane < planes.bands; ++plane) {
        const float factor = deviations[plane] > 0 ? 1 / deviations[plane] : 0;
        const PlaneView<float> view = planes.plane(plane);
        for (std::size_t i = 0; i < view.size(); ++i) view.data[i] *= factor;
    }
}

}  // namespace

std::vector<PlaneView<float>> windows_of(ImageView<float> image, std::size_t first,
                                         std::size_t count) {
    std::vector<PlaneView<float>> windows;
    for (std::size_t plane = 0; plane < image.bands; ++plane)
        windows.push_back(image.plane(plane).window(first, 0, count, image.cols));
    return windows;
}

Result<Finish> Finish::create(const Material& material, const SynthesisOptions& options,
                              Period period, Executor& executor) {
    Finish finish;
    finish.fields_only_ = options.fields_only;
    if (material.modulation) {
        finish.modulation_ = &*material.modulation;
        SATEEN_TRY(finish.amplitudes_,
                   AmplitudeFields::create(*material.modulation, options.seed, period,
                                           executor));
    }
    if (!material.structure) return finish;
    finish.structure_ = &*material.structure;
    SATEEN_TRY(finish.phase_, PeriodicPhase::create(material.structure->periodic,
                                                    options.seed, period, executor));
    return finish;
}

void Finish::modulate(const Subspace& subspace, Border border, std::int32_t row,
                      std::int32_t col, ImageView<float> fields,
                      Executor& executor) const {
    if (amplitudes_)
        modulate_planes(*modulation_, subspace, *amplitudes_, border, row, col, fields,
                        executor);
}

void Finish::operator()(const Subspace& subspace, std::int32_t row, std::int32_t col,
                        ImageView<float> planes, std::span<const PlaneView<float>> out,
                        Executor& executor) const {
    Subspace coloured;
    if (phase_) {
        apply_periodic_layer(*structure_, subspace, *phase_, row, col, planes, executor);
        coloured.spectral = subspace.spectral;
        coloured.marginals.assign(planes.bands, Marginal{1, {}});
    }
    if (!fields_only_) {
        invert_spectral(phase_ ? coloured : subspace, planes, out, executor);
        return;
    }
    if (phase_) divide(planes, plane_deviations(*structure_, subspace));
    for (std::size_t band = 0; band < planes.bands; ++band)
        if (out[band].data != planes.plane(band).data)
            std::copy_n(planes.plane(band).data, planes.plane_size(), out[band].data);
}

}  // namespace sateen

// SPDX-License-Identifier: Apache-2.0
// Band modulation applied. See modulate.hpp.
#include "material/modulate.hpp"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <utility>

#include "core/band_rows.hpp"

namespace sateen {
namespace {

constexpr std::size_t kLevels = BandModulation::kLevels;
constexpr std::size_t kRowsAtATime = 16;

KnotTable table_of(const AmplitudeCurve& curve, float low, float high) {
    KnotTable table;
    table.first = low;
    table.per_unit = static_cast<float>(AmplitudeCurve::kKnots - 1) / (high - low);
    for (std::size_t j = 0; j < AmplitudeCurve::kKnots; ++j)
        table.value[j] = AmplitudeCurve::kStep * static_cast<float>(curve.values[j]);
    for (std::size_t j = 0; j + 1 < AmplitudeCurve::kKnots; ++j)
        table.rise[j] = table.value[j + 1] - table.value[j];
    return table;
}

KnotTable amplitude_table(const AmplitudeCurve& curve) {
    return table_of(curve, ModulatedBand::kAmplitudeLow, ModulatedBand::kAmplitudeHigh);
}

bool is_flat(const AmplitudeCurve& curve) {
    return curve == AmplitudeCurve{};
}

}  // namespace

std::uint16_t upper_half(float value) {
    std::uint32_t bits = 0;
    std::memcpy(&bits, &value, sizeof bits);
    return static_cast<std::uint16_t>((bits + 0x8000U) >> 16U);
}

float from_upper_half(std::uint16_t half) {
    const std::uint32_t bits = std::uint32_t{half} << 16U;
    float value = 0;
    std::memcpy(&value, &bits, sizeof value);
    return value;
}

BandModulator::BandModulator(const BandModulation& fields, DrawAmplitudeField draw,
                             Border border, ImageView<float> planes, Executor& executor)
    : fields_(fields),
      draw_(std::move(draw)),
      border_(border),
      planes_(planes),
      executor_(executor),
      bands_(kLevels, planes.rows, planes.cols, uninitialised),
      first_(kLevels, planes.rows, planes.cols, uninitialised),
      work_(4, planes.rows, planes.cols, uninitialised),
      low_(work_.plane(0)),
      spare_(work_.plane(1)),
      energy_(work_.plane(2)),
      field_(work_.plane(3)) {}

void BandModulator::split(std::size_t plane) {
    PlaneView<const float> from = planes_.plane(plane);
    for (std::size_t level = 0; level < kLevels; ++level) {
        split_band(from, std::size_t{1} << level, border_, bands_.plane(level), low_,
                   executor_);
        std::swap(low_, spare_);
        from = spare_;
    }
    std::swap(low_, spare_);
}

void BandModulator::run(std::size_t plane, std::size_t level,
                        const SubspaceModulation& modulation, PlaneView<float> band,
                        PlaneView<float> low) {
    const ModulatedBand& how = modulation.bands[plane * kLevels + level];
    const KnotTable of_value =
        table_of(how.of_value, -ModulatedBand::kValueRange, ModulatedBand::kValueRange);
    const KnotTable of_parent = amplitude_table(how.of_parent);
    const KnotTable of_first = amplitude_table(how.of_first);
    const bool has_field = plane == 0 && fields_.fields[level].deviation > 0;
    const bool has_parent = level + 1 < kLevels && !is_flat(how.of_parent);
    const bool has_first = plane > 0 && !is_flat(how.of_first);
    if (has_field) draw_(level, field_, executor_);
    PlaneView<const float> parent = energy_;
    if (plane == 0 && level + 1 < kLevels) parent = first_.plane(level + 1);
    ModulatedRow common;
    common.of_value = is_flat(how.of_value) ? nullptr : &of_value;
    common.of_parent = &of_parent;
    common.of_first = &of_first;
    common.value_scale = how.value_scale;
    if (has_parent)
        common.parent_scale = modulation.bands[plane * kLevels + level + 1].energy_scale;
    if (has_first) common.first_scale = modulation.bands[level].energy_scale;
    common.gain = how.gain;
    const std::size_t pieces = (low.rows + kRowsAtATime - 1) / kRowsAtATime;
    parallel_for(executor_, pieces, [&](std::size_t piece) {
        const std::size_t end = std::min(low.rows, (piece + 1) * kRowsAtATime);
        for (std::size_t r = piece * kRowsAtATime; r < end; ++r) {
            ModulatedRow row = common;
            row.band = band.row(r);
            row.low = low.row(r);
            if (has_field) row.field = field_.row(r);
            if (has_parent) row.parent = parent.row(r);
            if (has_first) row.first = first_.plane(level).row(r);
            modulate_row(row, low.cols);
        }
    });
}

void BandModulator::modulate(std::size_t plane, std::size_t level,
                             const SubspaceModulation& modulation) {
    const PlaneView<float> band = bands_.plane(level);
    run(plane, level, modulation, band, low_);
    if (plane == 0) {
        local_energy(band, level, border_, spare_, first_.plane(level), executor_);
    } else if (level > 0 &&
               !is_flat(modulation.bands[plane * kLevels + level - 1].of_parent)) {
        local_energy(band, level, border_, spare_, energy_, executor_);
    }
}

PlaneView<const float> BandModulator::tried(std::size_t plane, std::size_t level,
                                            const SubspaceModulation& modulation) {
    Image copy(2, low_.rows, low_.cols, uninitialised);
    std::copy_n(low_.data, low_.size(), copy.plane(0).data);
    std::copy_n(bands_.plane(level).data, low_.size(), spare_.data);
    run(plane, level, modulation, spare_, copy.plane(0));
    return spare_;
}

void BandModulator::finish(std::size_t plane, float unit) {
    const PlaneView<float> out = planes_.plane(plane);
    for (std::size_t i = 0; i < out.size(); ++i) out.data[i] = unit * low_.data[i];
}

void modulate_bands(const BandModulation& fields, const SubspaceModulation& modulation,
                    DrawAmplitudeField draw, Border border, ImageView<float> planes,
                    Executor& executor) {
    BandModulator modulator(fields, std::move(draw), border, planes, executor);
    for (std::size_t plane = 0; plane < planes.bands; ++plane) {
        modulator.split(plane);
        for (std::size_t level = kLevels; level-- > 0;)
            modulator.modulate(plane, level, modulation);
        modulator.finish(plane, modulation.units[plane]);
    }
}

}  // namespace sateen

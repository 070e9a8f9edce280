// SPDX-License-Identifier: Apache-2.0
// Counting pixels in Lab, and cumulative features. See colour_histogram.hpp.
#include "sateen/analysis/colour_histogram.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "sateen/core/colour.hpp"

namespace sateen {
namespace {

// Pixels converted at a time: their planes stay in the first-level cache.
constexpr std::size_t kBlock = 512;
constexpr std::size_t kMaxBins = 512;

using Plane = std::array<float, kBlock>;

// Bin of every value. std::max with the constant first gives 0 for NaN.
void find_bins(std::span<const float> values, const Bins& bins,
               std::span<std::int32_t> found) {
    const auto scale = static_cast<float>(1.0 / bins.width);
    const auto offset = static_cast<float>(-bins.origin / bins.width);
    const auto last = static_cast<float>(bins.count - 1);
    for (std::size_t i = 0; i < values.size(); ++i) {
        const float x = std::max(0.0F, values[i] * scale + offset);
        found[i] = static_cast<std::int32_t>(std::min(last, x));
    }
}

// Counts of one channel. Neighbouring pixels often share a bin: counting them in turn in
// two tables spares an increment the wait for the one before.
class Counter {
  public:
    void add(std::span<const float> values, const Bins& bins) {
        std::array<std::int32_t, kBlock> found;
        find_bins(values, bins, std::span(found).first(values.size()));
        std::size_t i = 0;
        for (; i + 1 < values.size(); i += 2) {
            ++even_[static_cast<std::size_t>(found[i])];
            ++odd_[static_cast<std::size_t>(found[i + 1])];
        }
        if (i < values.size()) ++even_[static_cast<std::size_t>(found[i])];
    }

    [[nodiscard]] ChannelHistogram occupied() const {
        std::array<std::uint32_t, kMaxBins> sum;
        std::transform(even_.begin(), even_.end(), odd_.begin(), sum.begin(),
                       [](std::uint32_t a, std::uint32_t b) { return a + b; });
        const auto counted = [](std::uint32_t n) { return n != 0; };
        const auto first = std::find_if(sum.begin(), sum.end(), counted);
        const auto end = std::find_if(sum.rbegin(), sum.rend(), counted).base();
        if (first == sum.end()) return {};
        return {static_cast<std::uint32_t>(first - sum.begin()), {first, end}};
    }

  private:
    std::array<std::uint32_t, kMaxBins> even_ = {};
    std::array<std::uint32_t, kMaxBins> odd_ = {};
};

static_assert(kLabBins[0].count <= kMaxBins && kLabBins[1].count <= kMaxBins &&
              kLabBins[2].count <= kMaxBins);

}  // namespace

ColourHistogram colour_histogram(ImageView<const float> image,
                                 PlaneView<float> lightness) {
    assert(image.bands == 1 || image.bands == 3);
    const std::size_t count = image.plane_size();
    assert(lightness.data == nullptr ||
           (lightness.size() == count && lightness.contiguous()));
    std::array<Counter, 3> counters;
    std::array<Plane, 3> lab = {};
    for (std::size_t at = 0; at < count; at += kBlock) {
        const std::size_t size = std::min(kBlock, count - at);
        const auto band = [&](std::size_t b) {
            return std::span(image.data + b * count + at, size);
        };
        const auto out = [&](std::size_t c) { return std::span(lab[c]).first(size); };
        if (image.bands == 1) {
            lightness_from_linear(band(0), out(0));
        } else {
            lab_from_linear_srgb(band(0), band(1), band(2), out(0), out(1), out(2));
        }
        if (lightness.data != nullptr)
            std::copy_n(lab[0].begin(), size, lightness.data + at);
        for (std::size_t c = 0; c < 3; ++c) counters[c].add(out(c), kLabBins[c]);
    }
    ColourHistogram histogram;
    for (std::size_t c = 0; c < 3; ++c) histogram.channels[c] = counters[c].occupied();
    histogram.pixels = count;
    return histogram;
}

double mean_lightness(const ColourHistogram& histogram) {
    const ChannelHistogram& L = histogram.channels[0];
    double sum = 0;
    for (std::size_t i = 0; i < L.counts.size(); ++i)
        sum += L.counts[i] * (static_cast<double>(L.first + i) + 0.5);
    return sum * kLabBins[0].width / static_cast<double>(histogram.pixels);
}

FeatureGrid common_grid(std::span<const ColourHistogram> histograms) {
    FeatureGrid grid;
    for (const std::size_t c : {1U, 2U}) {
        std::size_t first = kLabBins[c].count;
        std::size_t end = 0;
        for (const ColourHistogram& histogram : histograms) {
            const ChannelHistogram& channel = histogram.channels[c];
            if (channel.counts.empty()) continue;
            first = std::min<std::size_t>(first, channel.first);
            end = std::max(end, channel.first + channel.counts.size());
        }
        if (end <= first) continue;
        grid.first[c] = first;
        grid.merge[c] = (end - first + kFeatureBins - 1) / kFeatureBins;
    }
    return grid;
}

void cumulative_feature(const ColourHistogram& histogram, const FeatureGrid& grid,
                        std::span<double, kColourFeatures> feature) {
    for (std::size_t c = 0; c < 3; ++c) {
        const ChannelHistogram& channel = histogram.channels[c];
        const double scale =
            std::sqrt(grid.width(c)) / static_cast<double>(histogram.pixels);
        // Pixels below the upper edge of the bin; `next` is the fine bin that follows.
        std::uint64_t below = 0;
        std::size_t next = 0;
        for (std::size_t b = 0; b < kFeatureBins; ++b) {
            const std::size_t edge = grid.first[c] + (b + 1) * grid.merge[c];
            for (; next < channel.counts.size() && channel.first + next < edge; ++next)
                below += channel.counts[next];
            feature[c * kFeatureBins + b] = scale * static_cast<double>(below);
        }
    }
}

}  // namespace sateen

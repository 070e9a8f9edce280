// SPDX-License-Identifier: Apache-2.0
#include "known_pairs.hpp"

#include <algorithm>
#include <utility>

namespace sateen::cli {
namespace {

using Vectors = std::vector<std::array<float, 3>>;

Vectors vectors_of(const std::vector<Direction>& directions) {
    Vectors out;
    for (const Direction d : directions) out.push_back(to_vector(d));
    return out;
}

float dot(const std::array<float, 3>& a, const std::array<float, 3>& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

// The same directions among `all`; the number of these for one that is missing there.
std::vector<std::size_t> places(const std::vector<Direction>& directions,
                                const Vectors& all) {
    constexpr float kSame = 1 - 1e-6F;
    std::vector<std::size_t> out;
    for (const auto& d : vectors_of(directions)) {
        const auto found = std::find_if(all.begin(), all.end(),
                                        [&](const auto& v) { return dot(d, v) > kSame; });
        out.push_back(static_cast<std::size_t>(found - all.begin()));
    }
    return out;
}

}  // namespace

SomeImages::SomeImages(const Measurement& all, std::vector<std::size_t> chosen)
    : all_(all), info_(all.info()), chosen_(std::move(chosen)) {
    info_.observations.clear();
    for (const std::size_t i : chosen_)
        info_.observations.push_back(all.info().observations[i]);
}

std::vector<std::size_t> evenly_spread(std::size_t all, std::size_t most) {
    const std::size_t count = most == 0 ? all : std::min(all, most);
    std::vector<std::size_t> out(count);
    // A step that is no divisor of a grid's rows does not miss a column of it.
    for (std::size_t i = 0; i < count; ++i) out[i] = i * all / count;
    return out;
}

KnownPairs::KnownPairs(const Material& material, const MeasurementInfo& info)
    : info_(info), views_(vectors_of(info.views)), lights_(vectors_of(info.lights)) {
    const std::vector<std::size_t> views = places(material.views, views_);
    const std::vector<std::size_t> lights = places(material.lights, lights_);
    std::vector<bool> pairs(views_.size() * lights_.size());
    for (const IndexEntry& entry : material.index)
        if (lights[entry.light] < lights_.size() && views[entry.view] < views_.size())
            pairs[lights[entry.light] * views_.size() + views[entry.view]] = true;
    for (std::size_t i = 0; i < info.observations.size(); ++i) {
        const Observation& o = info.observations[i];
        is_known_.push_back(pairs[o.light * views_.size() + o.view]);
        if (is_known_[i]) known_.push_back(i);
    }
}

std::size_t KnownPairs::nearest(const Observation& wanted) const {
    const auto closeness = [&](std::size_t i) {
        const Observation& o = info_.observations[i];
        return dot(views_[o.view], views_[wanted.view]) +
               dot(lights_[o.light], lights_[wanted.light]);
    };
    return *std::max_element(
        known_.begin(), known_.end(),
        [&](std::size_t a, std::size_t b) { return closeness(a) < closeness(b); });
}

}  // namespace sateen::cli

// SPDX-License-Identifier: Apache-2.0
// Tubes as rows of ellipsoids. See tubes.hpp.
#include "goniometer/tubes.hpp"

#include <cmath>

namespace sateen::goniometer {

void TubeCanvas::stamp(std::int32_t yarn, const AxisPoint& centre, float direction_x,
                       float direction_y, float along, float radius, float flatness) {
    const auto size = static_cast<float>(side_);
    const auto modulus = static_cast<std::int64_t>(side_);
    const auto first = [&](float middle) {
        return static_cast<std::int64_t>(std::floor((middle - radius) * size));
    };
    const auto last = [&](float middle) {
        return static_cast<std::int64_t>(std::ceil((middle + radius) * size));
    };
    for (std::int64_t r = first(centre.y); r <= last(centre.y); ++r)
        for (std::int64_t c = first(centre.x); c <= last(centre.x); ++c) {
            const float dx = (static_cast<float>(c) + 0.5F) / size - centre.x;
            const float dy = (static_cast<float>(r) + 0.5F) / size - centre.y;
            const float rest = radius * radius - dx * dx - dy * dy;
            if (rest <= 0) continue;
            const float z = centre.z + flatness * std::sqrt(rest);
            const auto row = static_cast<std::size_t>((r % modulus + modulus) % modulus);
            const auto col = static_cast<std::size_t>((c % modulus + modulus) % modulus);
            Uppermost& texel = texels_[row * side_ + col];
            if (z <= texel.z) continue;
            texel = {z, along, (dx * -direction_y + dy * direction_x) / radius, yarn};
        }
}

void TubeCanvas::draw(std::int32_t yarn, std::span<const AxisPoint> axis, float radius,
                      float flatness) {
    const float step = 0.5F / static_cast<float>(side_);
    float along = 0;
    for (std::size_t k = 0; k + 1 < axis.size(); ++k) {
        const AxisPoint& a = axis[k];
        const AxisPoint& b = axis[k + 1];
        const float dx = b.x - a.x;
        const float dy = b.y - a.y;
        const float length = std::sqrt(dx * dx + dy * dy);
        if (length <= 0) continue;
        const auto count = static_cast<std::size_t>(std::ceil(length / step));
        for (std::size_t i = 0; i < count; ++i) {
            const float t = static_cast<float>(i) / static_cast<float>(count);
            stamp(yarn, {a.x + t * dx, a.y + t * dy, a.z + t * (b.z - a.z)}, dx / length,
                  dy / length, along + t * length, radius, flatness);
        }
        along += length;
    }
}

}  // namespace sateen::goniometer

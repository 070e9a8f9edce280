// SPDX-License-Identifier: Apache-2.0
// Mean colour and contrast of a pair of directions. See reflectance.hpp.
#include "sateen/material/reflectance.hpp"

namespace sateen {

EncodedAppearance encoded_appearance(const Reflectance& reflectance,
                                     const DirectionWeights& view,
                                     const DirectionWeights& light) {
    const std::size_t rank = reflectance.rank;
    const std::size_t channels = reflectance.channels;
    std::array<float, Reflectance::kMaxRank> a{};
    for (std::size_t i = 0; i < 3; ++i) {
        const float* factors = reflectance.lights.data() + light.index[i] * rank;
        for (std::size_t k = 0; k < rank; ++k) a[k] += light.weight[i] * factors[k];
    }
    EncodedAppearance e{};
    for (std::size_t i = 0; i < 3; ++i) {
        if (view.weight[i] == 0) continue;
        const std::size_t first = view.index[i] * channels;
        for (std::size_t c = 0; c < channels; ++c) {
            const float* factors = reflectance.views.data() + (first + c) * rank;
            float sum = reflectance.base[first + c];
            for (std::size_t k = 0; k < rank; ++k) sum += a[k] * factors[k];
            e[c] += view.weight[i] * sum;
        }
    }
    return e;
}

EncodedAppearance encoded_appearance(const Reflectance& reflectance, std::size_t view,
                                     std::size_t light) {
    const auto alone = [](std::size_t i) {
        const auto index = static_cast<std::uint16_t>(i);
        return DirectionWeights{{index, index, index}, {1, 0, 0}};
    };
    return encoded_appearance(reflectance, alone(view), alone(light));
}

}  // namespace sateen

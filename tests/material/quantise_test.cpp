// SPDX-License-Identifier: Apache-2.0
#include "material/quantise.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <vector>

namespace sateen {
namespace {

std::vector<float> quantised(const std::vector<float>& values) {
    const int exponent = block_exponent(values);
    std::vector<float> out;
    for (const float value : values)
        out.push_back(dequantise(quantise(value, exponent), exponent));
    return out;
}

TEST(Quantise, ABlockIsExactTo15BitsOfItsLargestValueAndStableAfterwards) {
    std::mt19937 engine(1);
    for (int trial = 0; trial < 20000; ++trial) {
        // Random bits: every binade, subnormal numbers, values next to powers of two.
        std::vector<float> values(1 + engine() % 4);
        const auto binade = static_cast<int>(engine() % 260) - 150;
        for (float& value : values) {
            const auto mantissa = engine() % 8 == 0 ? 0xFFFFFFU : engine() >> 8U;
            value = std::ldexp(static_cast<float>(mantissa), binade - 24);
            if (engine() % 2 == 0) value = -value;
        }
        const std::vector<float> once = quantised(values);
        const int exponent = block_exponent(values);
        float largest = 0;
        for (const float value : values) largest = std::max(largest, std::abs(value));
        const float tolerance = std::max(largest / 32768, std::ldexp(1.0F, -112));
        for (std::size_t i = 0; i < values.size(); ++i)
            ASSERT_LE(std::abs(once[i] - values[i]), tolerance) << values[i];
        ASSERT_EQ(quantised(once), once);
        if (once != std::vector<float>(once.size(), 0.0F)) {
            ASSERT_EQ(block_exponent(once), exponent);
        }
    }
}

TEST(Quantise, ZerosAndVanishingValuesShareOneRepresentation) {
    EXPECT_EQ(block_exponent(std::vector<float>{}), 0);
    EXPECT_EQ(block_exponent(std::vector<float>{0, -0.0F}), 0);
    EXPECT_EQ(block_exponent(std::vector{std::numeric_limits<float>::denorm_min()}), 0);
}

TEST(Quantise, WholeAndQuarterDegreesComeBackAsTheyWere) {
    for (int quarters = -1440; quarters <= 1440; ++quarters) {
        const float degrees = static_cast<float>(quarters) / 4;
        const float radians = direction_from_degrees(degrees, 0).theta;
        ASSERT_EQ(quantised_degrees(radians), degrees);
    }
}

TEST(Quantise, AnyAngleIsWithinAThousandthOfADegreeAndStableAfterwards) {
    std::mt19937 engine(2);
    for (int trial = 0; trial < 100000; ++trial) {
        const float radians =
            (static_cast<float>(engine() >> 8U) / 16777216.0F - 0.5F) * 12.566F;
        const float degrees = quantised_degrees(radians);
        ASSERT_NEAR(degrees,
                    static_cast<double>(radians) / static_cast<double>(kRadiansPerDegree),
                    1.3e-4);
        ASSERT_EQ(quantised_degrees(direction_from_degrees(degrees, 0).theta), degrees);
    }
}

}  // namespace
}  // namespace sateen

// SPDX-License-Identifier: Apache-2.0
// De-lighting against a surface whose height and albedo are known, ray traced with shadows,
// gloss and interreflection.
#include "sateen/analysis/delight.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "goniometer/surfaces.hpp"
#include "support/relief.hpp"

namespace sateen {
namespace {

constexpr std::size_t kSide = 64;

/// Hills under a print of another direction and period, both toroidal.
SurfaceMaps printed_hills() {
    const double turn = 2 * std::numbers::pi / kSide;
    SurfaceMaps surface =
        test::grey_surface(2 * kSide, kSide, 0.5F, [&](float x, float y) {
            return static_cast<float>(2.2 * std::sin(3 * turn * static_cast<double>(x)) *
                                      std::cos(4 * turn * static_cast<double>(y)));
        });
    for (std::size_t b = 0; b < 3; ++b)
        for (std::size_t r = 0; r < 2 * kSide; ++r)
            for (std::size_t c = 0; c < 2 * kSide; ++c)
                surface.colour(b, r, c) = static_cast<float>(
                    0.5 + 0.12 * std::cos(0.5 * turn * (4 * static_cast<double>(r + c)) +
                                          static_cast<double>(b)));
    return surface;
}

/// Root mean square of the difference of two images, each over its mean.
double difference(const Image& a, const Image& b) {
    double means[2] = {};
    for (std::size_t i = 0; i < a.values().size(); ++i) {
        means[0] += static_cast<double>(a.values()[i]);
        means[1] += static_cast<double>(b.values()[i]);
    }
    const auto n = static_cast<double>(a.values().size());
    double sum = 0;
    for (std::size_t i = 0; i < a.values().size(); ++i) {
        const double e = n * (static_cast<double>(a.values()[i]) / means[0] -
                              static_cast<double>(b.values()[i]) / means[1]);
        sum += e * e;
    }
    return std::sqrt(sum / n);
}

class PrintedHills : public ::testing::Test {
  protected:
    void SetUp() override {
        GoniometerOptions options;
        options.rows = options.cols = kSide;
        const SurfaceMaps surface = printed_hills();
        auto goniometer = Goniometer::create(surface, {{}}, options, executor_);
        ASSERT_TRUE(goniometer);
        truth_ = goniometer->truth(executor_);
        auto measured = virtual_measurement(surface, {{}, direction_from_degrees(50, 90)},
                                            test::ring_lights(4, 8), options, executor_);
        ASSERT_TRUE(measured) << measured.error().message;
        measurement_ = std::move(*measured);
        Progress progress;
        auto range = estimate_range_map(*measurement_, {}, executor_, progress);
        ASSERT_TRUE(range && *range);
        range_ = std::move(**range);
    }

    /// The images of one view, with their shading.
    template <class F>
    void for_lights(std::uint32_t view, const F& f) {
        const MeasurementInfo& info = measurement_->info();
        for (std::size_t i = 0; i < info.observations.size(); i += 3) {
            const Observation& at = info.observations[i];
            if (at.view != view) continue;
            f(*measurement_->read(i),
              shading_seen(range_, info.views[view], info.lights[at.light]),
              info.lights[at.light]);
        }
    }

    SerialExecutor executor_;
    SurfaceMaps truth_;
    std::unique_ptr<Measurement> measurement_;
    RangeMap range_;
};

TEST_F(PrintedHills, LoseTheirShadingAndKeepTheirPrint) {
    int seen = 0;
    for_lights(0, [&](const Image& image, const Image& shading, Direction light) {
        if (light.theta < 25 * kRadiansPerDegree) return;
        const double raw = difference(image, truth_.colour);
        const double left = difference(divide_by_shading(image, shading), truth_.colour);
        EXPECT_LT(left, 0.5 * raw) << light.theta / kRadiansPerDegree;
        ++seen;
    });
    EXPECT_GT(seen, 5);
}

TEST_F(PrintedHills, AreRelitUnderAnotherLight) {
    std::optional<Image> print;
    for_lights(0, [&](const Image& image, const Image& shading, Direction) {
        if (!print) {
            print = divide_by_shading(image, shading);
            return;
        }
        Image relit = *print;
        for (std::size_t b = 0; b < 3; ++b)
            for (std::size_t i = 0; i < relit.plane_size(); ++i)
                relit.plane(b).data[i] *= shading.values()[i];
        EXPECT_GT(test::correlation(relit, image), 0.9);
    });
}

TEST_F(PrintedHills, AreSeenFromTheSideWithTheirParallax) {
    ExplainedContrast displaced;
    ExplainedContrast flat;
    for_lights(1, [&](const Image& image, const Image& shading, Direction light) {
        displaced.add(image, shading, 1);
        flat.add(image, shading_seen(range_, {}, light), 1);
    });
    EXPECT_GT(displaced.share(), 0.6);
    EXPECT_LT(flat.share(), displaced.share() - 0.05);
}

}  // namespace
}  // namespace sateen

// SPDX-License-Identifier: Apache-2.0
#include "sateen/analysis/segment.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <map>
#include <numeric>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "sateen/core/normal.hpp"
#include "support/threaded_executor.hpp"

namespace sateen {
namespace {

constexpr std::size_t kSize = 24;

// An image by observation number, or none for a file that cannot be read.
using Painter = std::function<Image(std::size_t)>;

// `views` x `lights` images, in order of (light, view).
class PaintedMeasurement final : public Measurement {
  public:
    PaintedMeasurement(std::size_t lights, std::size_t views, Painter paint,
                       float degrees_between_lights = 1)
        : paint_(std::move(paint)) {
        info_.bands = 3;
        info_.rows = info_.cols = kSize;
        for (std::size_t v = 0; v < views; ++v)
            info_.views.push_back(direction_from_degrees(
                75.0F * static_cast<float>(v) /
                    static_cast<float>(std::max(views, std::size_t{2}) - 1),
                0.0F));
        for (std::size_t l = 0; l < lights; ++l) {
            info_.lights.push_back(direction_from_degrees(
                30.0F, degrees_between_lights * static_cast<float>(l)));
            for (std::size_t v = 0; v < views; ++v)
                info_.observations.push_back({static_cast<std::uint32_t>(v),
                                              static_cast<std::uint32_t>(l),
                                              "image " + std::to_string(l * views + v)});
        }
    }
    [[nodiscard]] const MeasurementInfo& info() const override { return info_; }
    [[nodiscard]] Result<Image> read(std::size_t observation) const override {
        Image image = paint_(observation);
        if (image.empty())
            return Error{Errc::bad_format, info_.observations[observation].name};
        return image;
    }

  private:
    Painter paint_;
    MeasurementInfo info_;
};

// Grey noise about a level, another one for every number.
Image grain(std::size_t number, float level) {
    Image image(3, kSize, kSize);
    for (std::size_t r = 0; r < kSize; ++r) {
        std::array<float, kSize> row;
        draw_normals({number, 0}, static_cast<std::int32_t>(r), 0, row);
        for (std::size_t b = 0; b < 3; ++b)
            for (std::size_t c = 0; c < kSize; ++c)
                image(b, r, c) = level * (1.0F + 0.03F * row[c]);
    }
    return image;
}

// Levels of about equal steps of L: 90, 70, 50, 30.
constexpr std::array<float, 4> kLevels = {0.763F, 0.407F, 0.184F, 0.0623F};

Image planted(std::size_t number) {
    return grain(number, kLevels[number * 7 / 3 % 4]);
}

// The subspace of each planted level, dark first.
std::uint8_t planted_label(std::size_t number) {
    return static_cast<std::uint8_t>(3 - number * 7 / 3 % 4);
}

Segmentation run(const Measurement& measurement, const SegmentationOptions& options) {
    SerialExecutor serial;
    Progress progress;
    Result<Segmentation> result = segment(measurement, options, serial, progress);
    EXPECT_TRUE(result) << result.error().message;
    return *std::move(result);
}

Error failure(const Measurement& measurement, const SegmentationOptions& options) {
    SerialExecutor serial;
    Progress progress;
    return segment(measurement, options, serial, progress).error();
}

void expect_consistent(const Segmentation& found) {
    ASSERT_EQ(found.members.size(), found.representatives.size());
    for (std::size_t k = 0; k < found.members.size(); ++k) {
        EXPECT_EQ(found.members[k],
                  static_cast<std::size_t>(std::ranges::count(found.labels, k)));
        EXPECT_EQ(found.labels[found.representatives[k]], k);
    }
}

TEST(Segment, RecoversPlantedSubspacesFromDarkToLight) {
    const PaintedMeasurement measurement(6, 10, planted);
    for (const std::size_t subspaces : {4U, 0U}) {
        const Segmentation found = run(measurement, {.subspaces = subspaces});
        ASSERT_EQ(found.members.size(), 4U);
        for (std::size_t i = 0; i < 60; ++i) EXPECT_EQ(found.labels[i], planted_label(i));
        EXPECT_GT(found.explained, 0.95);
        expect_consistent(found);
    }
}

TEST(Segment, TellsTheSharesOfThePrincipalComponents) {
    // Four subspaces span three dimensions; what differs within them is small.
    const Segmentation found = run(PaintedMeasurement(6, 10, planted), {});
    const std::vector<double>& shares = found.eigenvalues;
    ASSERT_GE(shares.size(), 3U);
    EXPECT_TRUE(std::ranges::is_sorted(shares, std::greater<>()));
    EXPECT_NEAR(std::accumulate(shares.begin(), shares.end(), 0.0), 1, 1e-3);
    EXPECT_GT(shares[0] + shares[1] + shares[2], 0.95);
}

TEST(Segment, ExplainsTheShareThatWasAskedForWithNoMoreSubspacesThanItTakes) {
    // Lightness in 40 even steps.
    const PaintedMeasurement measurement(5, 8, [](std::size_t i) {
        return grain(i, std::pow((static_cast<float>(i) + 10.0F) / 50.0F, 3.0F));
    });
    std::size_t before = 0;
    for (const double share : {0.5, 0.8, 0.9, 0.95}) {
        const Segmentation found = run(measurement, {.share = share});
        EXPECT_GE(found.explained, share);
        const std::size_t subspaces = found.members.size();
        EXPECT_GT(subspaces, before);
        EXPECT_LT(run(measurement, {.subspaces = subspaces - 1}).explained, share);
        before = subspaces;
        expect_consistent(found);
    }
}

TEST(Segment, NeverTakesMoreThanTwentySubspacesByItself) {
    const PaintedMeasurement measurement(8, 8, [](std::size_t i) {
        return grain(i, std::pow((static_cast<float>(i) + 10.0F) / 80.0F, 3.0F));
    });
    const Segmentation found = run(measurement, {.share = 1.0});
    EXPECT_EQ(found.members.size(), 20U);
    expect_consistent(found);
}

TEST(Segment, MakesOneSubspaceOfIdenticalImages) {
    const PaintedMeasurement measurement(4, 5,
                                         [](std::size_t) { return grain(1, 0.3F); });
    for (const std::size_t subspaces : {0U, 1U, 7U}) {
        const Segmentation found = run(measurement, {.subspaces = subspaces});
        EXPECT_EQ(found.labels, std::vector<std::uint8_t>(20, 0));
        EXPECT_EQ(found.representatives, std::vector<std::size_t>{0});
        EXPECT_EQ(found.explained, 0.0);
    }
}

TEST(Segment, HandlesFewerImagesThanSubspaces) {
    const PaintedMeasurement three(1, 3,
                                   [](std::size_t i) { return grain(i, kLevels[i]); });
    EXPECT_EQ(run(three, {.subspaces = 20}).labels, (std::vector<std::uint8_t>{2, 1, 0}));
    const PaintedMeasurement one(1, 1, planted);
    EXPECT_EQ(run(one, {}).labels, std::vector<std::uint8_t>{0});
}

TEST(Segment, OfGreyImagesIsThatOfTheSameColourImages) {
    const PaintedMeasurement grey(6, 10, [](std::size_t i) {
        const Image colour = planted(i);
        Image image(1, kSize, kSize);
        std::copy_n(colour.values().begin(), image.plane_size(), image.values().begin());
        return image;
    });
    const Segmentation found = run(grey, {});
    EXPECT_EQ(found.labels, run(PaintedMeasurement(6, 10, planted), {}).labels);
}

TEST(Segment, DoesNotDependOnTheOrderOfTheObservations) {
    const Segmentation found = run(PaintedMeasurement(6, 10, planted), {});
    std::vector<std::size_t> order(60);
    for (std::size_t i = 0; i < 60; ++i) order[i] = i * 17 % 60;
    const PaintedMeasurement shuffled(6, 10,
                                      [&](std::size_t i) { return planted(order[i]); });
    const Segmentation other = run(shuffled, {});
    for (std::size_t i = 0; i < 60; ++i)
        EXPECT_EQ(other.labels[i], found.labels[order[i]]);
}

TEST(Segment, IsTheSameForAnyNumberOfThreads) {
    // Without gaps between the clusters, so that every bit counts.
    const PaintedMeasurement measurement(6, 10, [](std::size_t i) {
        return grain(i, 0.1F + 0.01F * static_cast<float>(i * 23 % 60));
    });
    const SegmentationOptions options = {.subspaces = 9};
    const Segmentation serial = run(measurement, options);
    for (const std::size_t threads : {2U, 4U}) {
        test::ThreadedExecutor executor(threads);
        Progress progress;
        const Result<Segmentation> found =
            segment(measurement, options, executor, progress);
        ASSERT_TRUE(found);
        EXPECT_EQ(found->labels, serial.labels);
        EXPECT_EQ(found->representatives, serial.representatives);
        EXPECT_EQ(found->explained, serial.explained);
    }
}

// Stripes with the same histogram, along the rows and along the columns.
Image stripes(std::size_t number, bool along_rows) {
    Image image = grain(number, 0.3F);
    for (std::size_t b = 0; b < 3; ++b)
        for (std::size_t r = 0; r < kSize; ++r)
            for (std::size_t c = 0; c < kSize; ++c)
                if ((along_rows ? r : c) / 3 % 2 == 0) image(b, r, c) *= 0.7F;
    return image;
}

TEST(Segment, TellsTheDirectionOfStripesByTheirOrientedContrastAlone) {
    const PaintedMeasurement measurement(
        4, 10, [](std::size_t i) { return stripes(i, i % 4 < 2); });
    const auto mixed = [](const Segmentation& found) {
        std::set<std::pair<bool, int>> seen;
        for (std::size_t i = 0; i < found.labels.size(); ++i)
            seen.insert({i % 4 < 2, found.labels[i]});
        return seen.size() > 2;
    };
    EXPECT_FALSE(mixed(run(measurement, {.subspaces = 2})));
    EXPECT_TRUE(mixed(run(measurement, {.subspaces = 2, .orientation_weight = 0})));
}

TEST(Segment, TellsTheSideThatContrastIsLitFrom) {
    // Ribs lit from φ = 0 and 180°: one picture, but its bright sides are the other's dark
    // ones. Half of the views do not see the ribs.
    const auto ribs = [](bool along_rows) {
        return PaintedMeasurement(
            2, 10,
            [=](std::size_t i) {
                return i % 2 == 0 ? stripes(i, along_rows) : grain(i, 0.25F);
            },
            180);
    };
    const auto sides_mixed = [](const Segmentation& found) {
        std::set<std::pair<bool, int>> seen;
        for (std::size_t i = 0; i < found.labels.size(); i += 2)
            seen.insert({i < 10, found.labels[i]});
        return seen.size() != 2 || seen.begin()->second == seen.rbegin()->second;
    };
    EXPECT_FALSE(sides_mixed(run(ribs(false), {.subspaces = 3})));
    EXPECT_TRUE(sides_mixed(run(ribs(false), {.subspaces = 3, .side_weight = 0})));
    // Of ribs along the light no side is lit.
    EXPECT_TRUE(sides_mixed(run(ribs(true), {.subspaces = 3})));
}

TEST(Segment, PrefersAViewFromAboveAmongMembersThatFitAlike) {
    // View 4 of 5 is at 75°; lights bring different grain, the level lies in the middle
    // for the grazing view alone.
    const PaintedMeasurement measurement(3, 5, [](std::size_t i) {
        constexpr std::array<float, 5> kLevel = {0.29F, 0.31F, 0.288F, 0.312F, 0.3F};
        return grain(i, kLevel[i % 5]);
    });
    const auto view_of = [&](double penalty) {
        const Segmentation found =
            run(measurement, {.subspaces = 1, .grazing_penalty = penalty});
        return measurement.info().observations[found.representatives[0]].view;
    };
    EXPECT_EQ(view_of(0), 4U);
    EXPECT_LT(view_of(10), 2U);
}

Image planted_with_gaps(std::size_t number) {
    return number % 11 == 3 ? Image() : planted(number);
}

TEST(Segment, LeavesOutUnreadableImagesIfAllowed) {
    const PaintedMeasurement measurement(6, 10, planted_with_gaps);
    const Segmentation found = run(measurement, {.skip_bad = true});
    ASSERT_EQ(found.members.size(), 4U);
    for (std::size_t i = 0; i < 60; ++i)
        EXPECT_EQ(found.labels[i], i % 11 == 3 ? kUnreadable : planted_label(i));
    EXPECT_EQ(found.pass.failed, (std::vector<std::size_t>{3, 14, 25, 36, 47, 58}));
    expect_consistent(found);
}

TEST(Segment, FailsWithTheFirstUnreadableImage) {
    const PaintedMeasurement measurement(6, 10, planted_with_gaps);
    EXPECT_EQ(failure(measurement, {}).code, Errc::bad_format);
    EXPECT_EQ(failure(measurement, {}).message, "image 3");
}

TEST(Segment, NamesTheOptionThatIsOutOfRange) {
    const PaintedMeasurement measurement(1, 2, planted);
    const std::map<std::string, SegmentationOptions> wrong = {
        {"subspaces", {.subspaces = 21}},
        {"share", {.share = 0}},
        {"restarts", {.restarts = 0}},
        {"orientation_weight", {.orientation_weight = -1}},
        {"side_weight", {.side_weight = -1}},
        {"grazing_penalty",
         {.grazing_penalty = std::numeric_limits<double>::quiet_NaN()}}};
    for (const auto& [name, options] : wrong) {
        const Error error = failure(measurement, options);
        EXPECT_EQ(error.code, Errc::invalid_argument);
        EXPECT_EQ(error.message.find(name), 0U) << error.message;
    }
    EXPECT_EQ(failure(PaintedMeasurement(0, 0, planted), {}).code,
              Errc::invalid_argument);
}

class StoppingProgress final : public Progress {
  public:
    void report(double done, double) override { stop_ = done >= 5; }
    [[nodiscard]] bool cancelled() const override { return stop_; }

  private:
    bool stop_ = false;
};

TEST(Segment, EndsWhenCancelled) {
    const PaintedMeasurement measurement(6, 10, planted);
    SerialExecutor serial;
    StoppingProgress progress;
    const Result<Segmentation> result = segment(measurement, {}, serial, progress);
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().code, Errc::cancelled);
}

}  // namespace
}  // namespace sateen

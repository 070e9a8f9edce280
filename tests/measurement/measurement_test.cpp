// SPDX-License-Identifier: Apache-2.0
#include "sateen/measurement/measurement.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

namespace sateen {
namespace {

/// Ten images of one pixel; the image of observation i has the value i.
class TenImages final : public Measurement {
  public:
    explicit TenImages(std::set<std::size_t> bad = {}) : bad_(std::move(bad)) {
        info_.observations.resize(10);
    }
    [[nodiscard]] const MeasurementInfo& info() const override { return info_; }
    [[nodiscard]] Result<Image> read(std::size_t i) const override {
        if (bad_.contains(i))
            return Error{Errc::bad_format, "image " + std::to_string(i) + ": bad"};
        Image image(1, 1, 1);
        image(0, 0, 0) = static_cast<float>(i);
        return image;
    }

  private:
    MeasurementInfo info_;
    std::set<std::size_t> bad_;
};

struct CancelAfter final : Progress {
    explicit CancelAfter(double limit_) : limit(limit_) {}
    void report(double done, double /*total*/) override { last = done; }
    [[nodiscard]] bool cancelled() const override { return last >= limit; }
    double limit;
    double last = 0;
};

TEST(ForEachImage, GivesEveryImageOnceWithItsNumber) {
    SerialExecutor executor;
    Progress progress;
    std::vector<float> seen(10, -1.0F);
    const auto report = for_each_image(
        TenImages(), false, executor, progress,
        [&](std::size_t i, const Image& image) { seen[i] = image(0, 0, 0); });
    ASSERT_TRUE(report);
    EXPECT_TRUE(report->failed.empty());
    EXPECT_THAT(seen, testing::ElementsAre(0, 1, 2, 3, 4, 5, 6, 7, 8, 9));
}

TEST(ForEachImage, FailsWithTheErrorOfAnUnreadableImage) {
    SerialExecutor executor;
    Progress progress;
    const auto report = for_each_image(TenImages({3, 7}), false, executor, progress,
                                       [](std::size_t, const Image&) {});
    ASSERT_FALSE(report);
    EXPECT_EQ(report.error().message, "image 3: bad");
}

TEST(ForEachImage, SkipsAndListsBadImagesInOrder) {
    SerialExecutor executor;
    Progress progress;
    int consumed = 0;
    const auto report = for_each_image(TenImages({7, 3}), true, executor, progress,
                                       [&](std::size_t, const Image&) { ++consumed; });
    ASSERT_TRUE(report);
    EXPECT_EQ(consumed, 8);
    EXPECT_THAT(report->failed, testing::ElementsAre(3U, 7U));
    EXPECT_THAT(report->reasons, testing::ElementsAre("image 3: bad", "image 7: bad"));
}

TEST(ForEachImage, FailsIfNoImageCanBeRead) {
    SerialExecutor executor;
    Progress progress;
    const auto report =
        for_each_image(TenImages({0, 1, 2, 3, 4, 5, 6, 7, 8, 9}), true, executor,
                       progress, [](std::size_t, const Image&) {});
    ASSERT_FALSE(report);
    EXPECT_THAT(report.error().message, testing::HasSubstr("image 0: bad"));
}

TEST(ForEachImage, StopsWhenAskedTo) {
    SerialExecutor executor;
    CancelAfter progress(4);
    int consumed = 0;
    const auto report = for_each_image(TenImages(), false, executor, progress,
                                       [&](std::size_t, const Image&) { ++consumed; });
    ASSERT_FALSE(report);
    EXPECT_EQ(report.error().code, Errc::cancelled);
    EXPECT_EQ(consumed, 4);
}

}  // namespace
}  // namespace sateen

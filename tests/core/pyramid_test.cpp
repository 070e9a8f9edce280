// SPDX-License-Identifier: Apache-2.0
#include "sateen/core/pyramid.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <numbers>
#include <numeric>
#include <vector>

#include "reference/pyramid.hpp"
#include "sateen/core/normal.hpp"

namespace sateen {
namespace {

Image random_image(std::size_t bands, std::size_t rows, std::size_t cols) {
    Image image(bands, rows, cols);
    for (std::size_t b = 0; b < bands; ++b) {
        for (std::size_t r = 0; r < rows; ++r) {
            draw_normals({1, static_cast<std::uint32_t>(b)}, static_cast<std::int32_t>(r),
                         0, {image.plane(b).row(r), cols});
        }
    }
    return image;
}

reference::DoublePlane as_double(PlaneView<const float> plane) {
    reference::DoublePlane out(plane.rows, plane.cols);
    for (std::size_t r = 0; r < plane.rows; ++r) {
        for (std::size_t c = 0; c < plane.cols; ++c)
            out(r, c) = static_cast<double>(plane(r, c));
    }
    return out;
}

void expect_near(PlaneView<const float> got, const reference::DoublePlane& expected,
                 double tolerance) {
    ASSERT_EQ(got.rows, expected.rows);
    ASSERT_EQ(got.cols, expected.cols);
    for (std::size_t r = 0; r < got.rows; ++r) {
        for (std::size_t c = 0; c < got.cols; ++c) {
            ASSERT_NEAR(static_cast<double>(got(r, c)), expected(r, c), tolerance)
                << r << ' ' << c;
        }
    }
}

// Runs the pieces of work backwards: the order must not matter.
class BackwardsExecutor final : public Executor {
  public:
    void run(std::size_t count, IndexFunction body) override {
        while (count-- > 0) body(count);
    }
    [[nodiscard]] std::size_t concurrency() const override { return 4; }
};

struct Shape {
    std::size_t bands, rows, cols, levels;
};
const std::vector<Shape> kShapes = {{1, 2, 2, 2},   {1, 4, 8, 3},    {3, 48, 80, 4},
                                    {2, 6, 130, 2}, {1, 136, 40, 4}, {1, 5, 7, 1}};

TEST(Pyramid, EqualsTheNaiveReference) {
    SerialExecutor executor;
    for (const Shape& s : kShapes) {
        const Image image = random_image(s.bands, s.rows, s.cols);
        const auto levels = decompose(image.view(), s.levels, executor);
        ASSERT_TRUE(levels);
        ASSERT_EQ(levels->size(), s.levels);
        for (std::size_t b = 0; b < s.bands; ++b) {
            const auto expected =
                reference::decompose(as_double(image.plane(b)), s.levels);
            for (std::size_t k = 0; k < s.levels; ++k) {
                expect_near((*levels)[k].plane(b), expected[k], 2e-6);
            }
        }
    }
}

TEST(Pyramid, ExpandEqualsTheNaiveReference) {
    SerialExecutor executor;
    const Image coarse = random_image(1, 9, 21);
    Image fine(1, 18, 42);
    expand(coarse.plane(0), fine.plane(0), executor);
    expect_near(fine.plane(0), reference::expand(as_double(coarse.plane(0))), 1e-6);
}

TEST(Pyramid, CollapseInvertsDecompose) {
    SerialExecutor executor;
    for (const Shape& s : kShapes) {
        const Image image = random_image(s.bands, s.rows, s.cols);
        auto levels = decompose(image.view(), s.levels, executor);
        ASSERT_TRUE(levels);
        const auto back = collapse(std::move(*levels), executor);
        ASSERT_TRUE(back);
        for (std::size_t b = 0; b < s.bands; ++b) {
            expect_near(back->plane(b), as_double(image.plane(b)), 1e-6);
        }
    }
}

TEST(Pyramid, ReferenceCollapseInvertsDecomposeToDoublePrecision) {
    const auto plane = as_double(random_image(1, 32, 48).plane(0));
    const auto back = reference::collapse(reference::decompose(plane, 4));
    for (std::size_t i = 0; i < plane.values.size(); ++i) {
        ASSERT_NEAR(back.values[i], plane.values[i], 1e-12);
    }
}

TEST(Pyramid, BandsHaveZeroMeanAndTheRestKeepsTheMean) {
    SerialExecutor executor;
    Image image = random_image(1, 96, 64);
    for (float& value : image.values()) value += 3.0F;
    const auto mean = [](const Image& band) {
        return std::accumulate(band.values().begin(), band.values().end(), 0.0) /
               static_cast<double>(band.plane_size());
    };
    const auto levels = decompose(image.view(), 5, executor);
    ASSERT_TRUE(levels);
    for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(mean((*levels)[k]), 0, 1e-6) << k;
    EXPECT_NEAR(mean((*levels)[4]), mean(image), 1e-6);
}

TEST(Pyramid, DoesNotDependOnTheExecutor) {
    SerialExecutor serial;
    BackwardsExecutor backwards;
    const Image image = random_image(2, 160, 96);
    const auto expected = decompose(image.view(), 4, serial);
    const auto got = decompose(image.view(), 4, backwards);
    ASSERT_TRUE(expected && got);
    for (std::size_t k = 0; k < 4; ++k) {
        ASSERT_THAT((*got)[k].values(),
                    testing::ElementsAreArray((*expected)[k].values().begin(),
                                              (*expected)[k].values().end()));
    }
}

TEST(Pyramid, RefusesSizesThatDoNotDivide) {
    SerialExecutor executor;
    const Image image(1, 24, 20);
    const auto result = decompose(image.view(), 4, executor);
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().code, Errc::invalid_argument);
    EXPECT_EQ(result.error().message,
              "pyramid: 4 levels need columns divisible by 2^3, found 20");
    EXPECT_FALSE(decompose(image.view(), 0, executor));
    EXPECT_FALSE(decompose(Image().view(), 1, executor));
}

TEST(Pyramid, RefusesToCollapseLevelsOfWrongSize) {
    SerialExecutor executor;
    EXPECT_FALSE(collapse({}, executor));
    std::vector<Image> levels;
    levels.emplace_back(1, 8, 8);
    levels.emplace_back(1, 4, 8);
    const auto result = collapse(levels, executor);
    ASSERT_FALSE(result);
    EXPECT_EQ(
        result.error().message,
        "pyramid: level 1 is 1 x 4 x 8, expected half the size of level 0, 1 x 8 x 8");
}

TEST(PyramidTransfer, IsTheTransformOfTheKernel) {
    for (double omega = -4; omega < 4; omega += 0.17) {
        const double sum = (6 + 8 * std::cos(omega) + 2 * std::cos(2 * omega)) / 16;
        EXPECT_NEAR(pyramid_transfer(omega), sum, 1e-15);
    }
    EXPECT_EQ(pyramid_transfer(0), 1);
    EXPECT_NEAR(pyramid_transfer(std::numbers::pi), 0, 1e-60);
}

TEST(PyramidTransfer, SaysWhatExpandDoesToACosine) {
    // ↑ turns cos(2ωx) on the coarse lattice into W(ω) cos ωx and the image W(π-ω) cos
    // (π-ω)x.
    SerialExecutor executor;
    const double omega = 2 * std::numbers::pi * 3 / 32;
    Image coarse(1, 1, 16);
    for (std::size_t x = 0; x < 16; ++x) {
        coarse(0, 0, x) =
            static_cast<float>(std::cos(2 * omega * static_cast<double>(x)));
    }
    Image fine(1, 2, 32);
    expand(coarse.plane(0), fine.plane(0), executor);
    for (std::size_t x = 0; x < 32; ++x) {
        const auto at = static_cast<double>(x);
        const double mirror = std::numbers::pi - omega;
        EXPECT_NEAR(static_cast<double>(fine(0, 0, x)),
                    pyramid_transfer(omega) * std::cos(omega * at) +
                        pyramid_transfer(mirror) * std::cos(mirror * at),
                    1e-6);
    }
}

// A plane of noise as far as it is looked at.
Image window_of_noise(LatticePoint origin, std::size_t rows, std::size_t cols) {
    Image image(1, rows, cols);
    for (std::size_t r = 0; r < rows; ++r) {
        draw_normals({9, 0}, origin.row + static_cast<std::int32_t>(r), origin.col,
                     {image.plane(0).row(r), cols});
    }
    return image;
}

Image expanded_window(LatticePoint origin, std::size_t rows, std::size_t cols) {
    SerialExecutor executor;
    const LatticeRange r = expand_support({origin.row, rows});
    const LatticeRange c = expand_support({origin.col, cols});
    const Image coarse = window_of_noise({r.first, c.first}, r.count, c.count);
    Image fine(1, rows, cols);
    expand_window(coarse.plane(0), {r.first, c.first}, fine.plane(0), origin, executor);
    return fine;
}

TEST(ExpandSupport, IsTheSmallestThatServes) {
    const auto check = [](std::int32_t first, std::size_t count,
                          std::int32_t coarse_first, std::size_t coarse_count) {
        const LatticeRange support = expand_support({first, count});
        EXPECT_EQ(support.first, coarse_first) << first << ' ' << count;
        EXPECT_EQ(support.count, coarse_count) << first << ' ' << count;
    };
    check(0, 1, -1, 3);
    check(1, 1, 0, 2);
    check(0, 2, -1, 3);
    check(-1, 1, -1, 2);
    check(-2, 1, -2, 3);
    check(-3, 5, -2, 4);
    check(10, 100, 4, 52);
}

TEST(ExpandWindow, WindowsAgreeToTheBitWhereTheyOverlap) {
    const Image large = expanded_window({-37, -53}, 90, 120);
    for (const std::int32_t row : {-37, -20, -1, 0, 3}) {
        for (const std::int32_t col : {-53, -30, -2, -1, 0, 1, 2}) {
            for (const std::size_t size : {1U, 2U, 3U, 33U, 40U}) {
                const Image small = expanded_window({row, col}, size, size + 1);
                for (std::size_t r = 0; r < size; ++r) {
                    for (std::size_t c = 0; c < size + 1; ++c) {
                        ASSERT_EQ(small(0, r, c),
                                  large(0, static_cast<std::size_t>(row + 37) + r,
                                        static_cast<std::size_t>(col + 53) + c));
                    }
                }
            }
        }
    }
}

TEST(ExpandWindow, EqualsTheToroidalExpansionAwayFromTheSeam) {
    SerialExecutor executor;
    const Image coarse = window_of_noise({0, 0}, 20, 30);
    Image torus(1, 40, 60);
    expand(coarse.plane(0), torus.plane(0), executor);
    // The widest window whose support is inside.
    Image window(1, 36, 56);
    expand_window(coarse.plane(0), {0, 0}, window.plane(0), {1, 1}, executor);
    for (std::size_t r = 0; r < 36; ++r) {
        for (std::size_t c = 0; c < 56; ++c)
            ASSERT_EQ(window(0, r, c), torus(0, r + 1, c + 1));
    }
}

TEST(ExpandWindow, AddsToWhatIsThere) {
    SerialExecutor executor;
    const LatticePoint origin{-5, 3};
    const LatticeRange r = expand_support({origin.row, 11});
    const LatticeRange c = expand_support({origin.col, 14});
    // A coarse window with more margin than it needs.
    const LatticePoint coarse_origin{r.first - 2, c.first - 3};
    const Image coarse = window_of_noise(coarse_origin, r.count + 5, c.count + 4);
    const Image expanded = expanded_window(origin, 11, 14);
    Image sum = random_image(1, 11, 14);
    const Image before = sum;
    expand_add_window(coarse.plane(0), coarse_origin, sum.plane(0), origin, executor);
    for (std::size_t i = 0; i < sum.plane_size(); ++i) {
        ASSERT_EQ(sum.values()[i], before.values()[i] + expanded.values()[i]);
    }
}

}  // namespace
}  // namespace sateen

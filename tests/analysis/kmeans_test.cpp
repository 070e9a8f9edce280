// SPDX-License-Identifier: Apache-2.0
#include "sateen/analysis/kmeans.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <set>
#include <vector>

#include "reference/kmeans.hpp"
#include "sateen/core/normal.hpp"
#include "support/threaded_executor.hpp"

namespace sateen {
namespace {

using Points = BasicImage<double>;

PlaneView<const double> view(const Points& points) {
    return points.view().plane(0);
}

Points normal_points(std::size_t count, std::size_t features, std::uint64_t seed) {
    Points points(1, count, features);
    std::vector<float> row(features);
    for (std::size_t i = 0; i < count; ++i) {
        draw_normals({seed, 0}, static_cast<std::int32_t>(i), 0, row);
        for (std::size_t f = 0; f < features; ++f)
            points(0, i, f) = static_cast<double>(row[f]);
    }
    return points;
}

Clustering cluster(const Points& points, const KMeansOptions& options) {
    SerialExecutor serial;
    return kmeans(view(points), options, serial);
}

double distance2(const Points& points, const Clustering& found, std::size_t i,
                 std::size_t k) {
    double sum = 0;
    for (std::size_t f = 0; f < points.cols(); ++f) {
        const double d = points(0, i, f) - found.centres[k * points.cols() + f];
        sum += d * d;
    }
    return sum;
}

TEST(KMeans, FindsTheLeastInertiaOfAllPartitionsOfAFewPoints) {
    for (std::uint64_t seed = 0; seed < 5; ++seed) {
        const Points points = normal_points(9, 2, seed);
        for (const std::size_t clusters : {1U, 2U, 3U, 4U}) {
            const Clustering found =
                cluster(points, {.clusters = clusters, .restarts = 50});
            EXPECT_EQ(found.clusters, clusters);
            EXPECT_NEAR(found.inertia, reference::least_inertia(view(points), clusters),
                        1e-12);
        }
    }
}

TEST(KMeans, RecoversPlantedClusters) {
    // Five centres, 20 standard deviations apart.
    Points points = normal_points(300, 7, 1);
    for (std::size_t i = 0; i < points.rows(); ++i) points(0, i, i % 5) += 20.0;
    const Clustering found = cluster(points, {.clusters = 5});
    std::set<std::uint32_t> labels;
    for (std::size_t i = 0; i < points.rows(); ++i) {
        EXPECT_EQ(found.labels[i], found.labels[i % 5]);
        labels.insert(found.labels[i]);
    }
    EXPECT_EQ(labels.size(), 5U);
}

// What Lloyd's iteration ends with, and what bounds that are too tight would spoil.
TEST(KMeans, PutsEveryPointWithItsNearestCentreAndEveryCentreAtItsMean) {
    for (const std::size_t features : {1U, 3U, 4U, 9U}) {
        const Points points = normal_points(700, features, features);
        const Clustering found = cluster(points, {.clusters = 17, .restarts = 2});
        ASSERT_EQ(found.clusters, 17U);
        for (std::size_t i = 0; i < points.rows(); ++i) {
            const double own = distance2(points, found, i, found.labels[i]);
            for (std::size_t k = 0; k < found.clusters; ++k)
                ASSERT_LE(own, distance2(points, found, i, k) + 1e-12);
        }
        for (std::size_t k = 0; k < found.clusters; ++k) {
            for (std::size_t f = 0; f < features; ++f) {
                double sum = 0;
                double count = 0;
                for (std::size_t i = 0; i < points.rows(); ++i) {
                    if (found.labels[i] != k) continue;
                    sum += points(0, i, f);
                    ++count;
                }
                EXPECT_NEAR(found.centres[k * features + f], sum / count, 1e-12);
            }
        }
        EXPECT_NEAR(found.inertia, reference::inertia(view(points), found.labels, 17),
                    1e-9);
    }
}

TEST(KMeans, IsTheSameForAnyNumberOfThreads) {
    const Points points = normal_points(400, 6, 2);
    const Clustering serial = cluster(points, {.clusters = 8, .seed = 5});
    for (const std::size_t threads : {2U, 5U}) {
        test::ThreadedExecutor executor(threads);
        const Clustering found =
            kmeans(view(points), {.clusters = 8, .seed = 5}, executor);
        EXPECT_EQ(found.labels, serial.labels);
        EXPECT_EQ(found.centres, serial.centres);
        EXPECT_EQ(found.inertia, serial.inertia);
    }
}

TEST(KMeans, IsNeverWorseWithMoreRestarts) {
    const Points points = normal_points(200, 3, 3);
    double before = std::numeric_limits<double>::infinity();
    for (const std::uint32_t restarts : {1U, 2U, 5U, 20U}) {
        const double inertia =
            cluster(points, {.clusters = 12, .restarts = restarts}).inertia;
        EXPECT_LE(inertia, before);
        before = inertia;
    }
}

TEST(KMeans, LeavesNoClusterEmpty) {
    const Points points = normal_points(40, 2, 4);
    for (std::size_t clusters = 1; clusters <= 40; ++clusters) {
        const Clustering found = cluster(points, {.clusters = clusters, .restarts = 3});
        ASSERT_EQ(found.clusters, clusters);
        const std::set<std::uint32_t> labels(found.labels.begin(), found.labels.end());
        EXPECT_EQ(labels.size(), clusters);
        if (clusters == 40) {
            EXPECT_EQ(found.inertia, 0.0);
        }
    }
}

TEST(KMeans, MakesNoMoreClustersThanThereAreDistinctPoints) {
    Points points(1, 12, 2);
    for (std::size_t i = 0; i < 12; ++i) points(0, i, 0) = static_cast<double>(i % 3);
    const Clustering found = cluster(points, {.clusters = 10});
    EXPECT_EQ(found.clusters, 3U);
    EXPECT_EQ(found.inertia, 0.0);
    EXPECT_EQ(cluster(Points(1, 1, 1), {.clusters = 4}).clusters, 1U);
}

TEST(KMeans, TakesPointsWithinTheResolutionForEqual) {
    Points points = normal_points(50, 3, 5);
    for (std::size_t i = 0; i < 50; ++i) {
        for (std::size_t f = 0; f < 3; ++f)
            points(0, i, f) = 1e-9 * points(0, i, f) + static_cast<double>(i % 2);
    }
    EXPECT_EQ(cluster(points, {.clusters = 10, .resolution = 1e-6}).clusters, 2U);
    EXPECT_EQ(cluster(points, {.clusters = 10}).clusters, 10U);
}

}  // namespace
}  // namespace sateen

// SPDX-License-Identifier: Apache-2.0
#include "sateen/core/direction_mesh.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <set>
#include <vector>

#include "support/directions.hpp"

namespace sateen {
namespace {

using test::ubo2003_directions;
using Vec = std::array<float, 3>;

float dot(const Vec& a, const Vec& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

// Uniform on the hemisphere.
class RandomDirections {
  public:
    explicit RandomDirections(std::uint64_t seed) : engine_(seed) {}
    double uniform() { return static_cast<double>(engine_() >> 11U) * 0x1p-53; }
    Vec operator()() {
        const double z = uniform();
        const double phi = 6.283185307179586 * uniform();
        const double r = std::sqrt(1 - z * z);
        return {static_cast<float>(r * std::cos(phi)),
                static_cast<float>(r * std::sin(phi)), static_cast<float>(z)};
    }

  private:
    std::mt19937_64 engine_;
};

// The weights as a vector over the whole set.
std::vector<float> dense(const DirectionWeights& w, std::size_t n) {
    std::vector<float> out(n);
    for (std::size_t k = 0; k < 3; ++k) out[w.index[k]] += w.weight[k];
    return out;
}

// What every set must give: a partition of unity by numbers within the set.
void expect_weights(const DirectionWeights& w, std::size_t n) {
    float sum = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        ASSERT_LT(w.index[k], n);
        ASSERT_GE(w.weight[k], 0.0F);
        sum += w.weight[k];
    }
    ASSERT_NEAR(sum, 1, 1e-5);
}

// Weights at both ends of short steps all over the hemisphere differ by at most `slope`
// times the step.
void expect_continuous(const std::vector<Direction>& set, std::size_t count,
                       float slope) {
    const auto mesh = DirectionMesh::create(set);
    ASSERT_TRUE(mesh) << mesh.error().message;
    RandomDirections random(5);
    constexpr float kStep = 1e-3F;
    for (std::size_t i = 0; i < count; ++i) {
        const Vec a = random();
        const Vec way = random();
        Vec b = {a[0] + kStep * way[0], a[1] + kStep * way[1],
                 std::max(0.0F, a[2] + kStep * (way[2] - 0.5F))};
        const float length = std::sqrt(dot(b, b));
        for (float& x : b) x /= length;
        const auto before = mesh->interpolate(a);
        const auto after = mesh->interpolate(b);
        expect_weights(before, set.size());
        const auto wa = dense(before, set.size());
        const auto wb = dense(after, set.size());
        for (std::size_t k = 0; k < set.size(); ++k)
            ASSERT_NEAR(wa[k], wb[k], slope * kStep)
                << "direction " << k << " near " << a[0] << ", " << a[1] << ", " << a[2];
    }
}

TEST(DirectionMesh, TheDirectionsOfUbo2003MakeTheTrianglesOfTheReference) {
    const auto set = ubo2003_directions();
    ASSERT_EQ(set.size(), 81U);
    const auto mesh = DirectionMesh::create(set);
    ASSERT_TRUE(mesh);
    EXPECT_EQ(mesh->triangles(), 136U);
    EXPECT_EQ(mesh->cells().size(), 136U + 24U);
    // Euler: every triangle has three edges, inner ones shared by two.
    std::set<std::pair<int, int>> edges;
    for (const DirectionCell& cell : mesh->cells().first(mesh->triangles()))
        for (std::size_t k = 0; k < 3; ++k)
            edges.insert(std::minmax<int>(cell.vertex[k], cell.vertex[(k + 1) % 3]));
    EXPECT_EQ(81 - static_cast<int>(edges.size()) + 136, 1);
}

TEST(DirectionMesh, NoDirectionLiesInTheCircleOfATriangle) {
    std::vector<Direction> set = ubo2003_directions();
    std::mt19937_64 engine(3);
    for (Direction& d : set) {
        d.theta += static_cast<float>(engine() % 1000) * 2e-5F;
        d.phi += static_cast<float>(engine() % 1000) * 2e-5F;
    }
    const auto mesh = DirectionMesh::create(set);
    ASSERT_TRUE(mesh);
    for (const DirectionCell& cell : mesh->cells().first(mesh->triangles())) {
        const Vec a = to_vector(set[cell.vertex[0]]);
        const Vec b = to_vector(set[cell.vertex[1]]);
        const Vec c = to_vector(set[cell.vertex[2]]);
        const Vec u = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
        const Vec v = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
        const Vec normal = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2],
                            u[0] * v[1] - u[1] * v[0]};
        const float offset = dot(normal, a);
        EXPECT_GT(offset, 0);
        for (const Direction& d : set)
            EXPECT_LE(dot(normal, to_vector(d)), offset + 1e-6F);
    }
}

TEST(DirectionMesh, WeightsOfAMillionDirectionsReproduceTheDirection) {
    const auto set = ubo2003_directions();
    const auto mesh = DirectionMesh::create(set);
    ASSERT_TRUE(mesh);
    RandomDirections random(1);
    for (int i = 0; i < 1000000; ++i) {
        const Vec d = random();
        const DirectionWeights w = mesh->interpolate(d);
        expect_weights(w, set.size());
        Vec sum{};
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec v = to_vector(set[w.index[k]]);
            for (std::size_t c = 0; c < 3; ++c) sum[c] += w.weight[k] * v[c];
        }
        const float length = std::sqrt(dot(sum, sum));
        if (d[2] > 0.27F) {  // inside, where the chords of the last ring do not cut off
            ASSERT_NEAR(dot(sum, d) / length, 1, 1e-5) << "theta " << std::acos(d[2]);
        } else if (d[2] < 0.25F) {
            // Past the rim: the point of it on the same meridian.
            ASSERT_NEAR((sum[0] * d[1] - sum[1] * d[0]) / length, 0, 1e-4);
            ASSERT_NEAR(sum[2] / length, 0.2588, 0.003);
        }
    }
}

TEST(DirectionMesh, WeightsAreContinuous) {
    expect_continuous(ubo2003_directions(), 200000, 12);
}

TEST(DirectionMesh, IsExactAtTheDirectionsThemselves) {
    std::vector<Direction> set = ubo2003_directions();
    set.push_back(direction_from_degrees(90, 10));
    set.push_back(direction_from_degrees(89, 200));
    const auto mesh = DirectionMesh::create(set);
    ASSERT_TRUE(mesh);
    for (std::size_t i = 0; i < set.size(); ++i) {
        EXPECT_NEAR(dense(mesh->interpolate(set[i]), set.size())[i], 1, 2e-3) << i;
        EXPECT_EQ(mesh->nearest(to_vector(set[i])), i);
    }
}

TEST(DirectionMesh, TriangulatesScatteredSets) {
    for (const std::size_t n : {3U, 4U, 5U, 7U, 20U, 300U, 3000U}) {
        RandomDirections random(n);
        std::vector<Direction> set;
        for (std::size_t i = 0; i < n; ++i) {
            const Vec d = random();
            set.push_back({std::acos(d[2]), std::atan2(d[1], d[0])});
        }
        const auto mesh = DirectionMesh::create(set);
        ASSERT_TRUE(mesh);
        for (std::size_t i = 0; i < n; ++i)
            EXPECT_GT(dense(mesh->interpolate(set[i]), n)[i], 0.98F) << i << " of " << n;
        for (int i = 0; i < 20000; ++i) expect_weights(mesh->interpolate(random()), n);
    }
}

TEST(DirectionMesh, ScatteredSetsAreContinuousAlsoPastTheRim) {
    // A patch beside the normal: lights of a desk lamp on one side.
    std::vector<Direction> set;
    for (int theta = 30; theta <= 60; theta += 15)
        for (int phi = -40; phi <= 40; phi += 20)
            set.push_back(direction_from_degrees(static_cast<float>(theta),
                                                 static_cast<float>(phi)));
    expect_continuous(set, 50000, 40);
}

TEST(DirectionMesh, OneDirectionAnswersForAll) {
    const std::vector<Direction> set = {direction_from_degrees(30, 40)};
    expect_continuous(set, 100, 0);
}

TEST(DirectionMesh, TwoDirectionsShareTheHemisphere) {
    const std::vector<Direction> set = {direction_from_degrees(60, 0),
                                        direction_from_degrees(60, 180)};
    expect_continuous(set, 10000, 2);
    const auto mesh = DirectionMesh::create(set);
    ASSERT_TRUE(mesh);
    EXPECT_NEAR(dense(mesh->interpolate(Vec{0, 0, 1}), 2)[0], 0.5, 1e-6);
    EXPECT_EQ(dense(mesh->interpolate(Vec{1, 0, 0}), 2)[0], 1);
}

TEST(DirectionMesh, DirectionsOnAGreatCircleAreLinearBetweenNeighbours) {
    std::vector<Direction> set;
    for (const int theta : {60, 0, 30, 75, 45, 15})
        set.push_back(direction_from_degrees(static_cast<float>(theta), 70));
    set.push_back(direction_from_degrees(40, 250));
    const auto mesh = DirectionMesh::create(set);
    ASSERT_TRUE(mesh);
    EXPECT_EQ(mesh->triangles(), 0U);
    for (std::size_t i = 0; i < set.size(); ++i)
        EXPECT_NEAR(dense(mesh->interpolate(set[i]), set.size())[i], 1, 1e-4);
    const auto between =
        dense(mesh->interpolate(direction_from_degrees(20, 70)), set.size());
    EXPECT_NEAR(between[2] + between[5], 1, 1e-6);
    EXPECT_GT(between[5], between[2]);
    expect_continuous(set, 10000, 5);
}

TEST(DirectionMesh, ARingIsAPolygon) {
    std::vector<Direction> ring;
    for (int phi = 0; phi < 360; phi += 45)
        ring.push_back(direction_from_degrees(45, static_cast<float>(phi)));
    expect_continuous(ring, 20000, 20);
    const auto mesh = DirectionMesh::create(ring);
    ASSERT_TRUE(mesh);
    EXPECT_EQ(mesh->triangles(), 6U);
    // On the horizon too.
    for (Direction& d : ring) d.theta = 90 * kRadiansPerDegree;
    expect_continuous(ring, 20000, 400);
}

TEST(DirectionMesh, RepeatedDirectionsCountOnce) {
    std::vector<Direction> set = ubo2003_directions();
    const auto once = set.size();
    set.insert(set.end(), set.begin(), set.begin() + 40);
    set.push_back(direction_from_degrees(0, 90));  // the pole by another name
    const auto mesh = DirectionMesh::create(set);
    ASSERT_TRUE(mesh);
    EXPECT_EQ(mesh->triangles(), 136U);
    for (std::size_t i = 0; i < once; ++i) {
        const auto w = dense(mesh->interpolate(set[i]), set.size());
        EXPECT_NEAR(*std::max_element(w.begin(), w.end()), 1, 1e-4);
    }
}

TEST(DirectionMesh, RefusesWhatHasNoAnswer) {
    const auto none = DirectionMesh::create({});
    ASSERT_FALSE(none);
    EXPECT_EQ(none.error().message, "0 directions to interpolate, expected 1 to 20000");
    const std::vector<Direction> below = {{}, direction_from_degrees(100, 0)};
    const auto refused = DirectionMesh::create(below);
    ASSERT_FALSE(refused);
    EXPECT_NE(refused.error().message.find("direction 1 lies below"), std::string::npos);
}

// algorithms h2: the three nearest do not enclose 8 % of directions.
TEST(DirectionMesh, TheThreeNearestOftenMissTheDirection) {
    const auto set = ubo2003_directions();
    const auto mesh = DirectionMesh::create(set);
    ASSERT_TRUE(mesh);
    RandomDirections random(2);
    int differ = 0;
    int inside = 0;
    for (int i = 0; i < 100000; ++i) {
        const Vec d = random();
        const DirectionWeights w = mesh->nearest_three(d);
        expect_weights(w, set.size());
        if (d[2] < 0.27F) continue;
        ++inside;
        const auto a = dense(w, set.size());
        const auto b = dense(mesh->interpolate(d), set.size());
        float distance = 0;
        for (std::size_t k = 0; k < set.size(); ++k) distance += std::abs(a[k] - b[k]);
        differ += distance > 0.01F ? 1 : 0;
    }
    const double share = static_cast<double>(differ) / inside;
    EXPECT_GT(share, 0.1);
    EXPECT_LT(share, 0.4);
}

}  // namespace
}  // namespace sateen

// SPDX-License-Identifier: Apache-2.0
// A colour car2d texture of 512 x 512 by the recursion, three planes of three levels,
// against drawing its noise. One thread.
//     noise    the normals of exactly the sites of the levels, into planes
//     rows     noise and recursion of the same sites, kept nowhere
//     texture  RecursiveField::draw: with margins and the sum of the levels
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <limits>
#include <utility>
#include <vector>

#include "sateen/core/image.hpp"
#include "sateen/core/normal.hpp"
#include "sateen/core/parallel.hpp"
#include "synthesis/causal_recursion.hpp"
#include "synthesis/recursive_field.hpp"

namespace {

constexpr std::size_t kSize = 512;
constexpr std::uint32_t kPlanes = 3;
constexpr std::size_t kLevels = 3;
constexpr int kRepeats = 41;

struct Model {
    const char* name;
    std::vector<sateen::CausalTap> taps;
};

// [CAR2] uses the three neighbours; orders 2, 4 and 6 of the half plane have 4, 10 and
// 14. A separable field of correlation ρ has the taps (ρ, ρ, -ρ²), and a margin of
// ln 1000 / -ln ρ sites.
std::vector<Model> models() {
    const std::vector<sateen::CausalTap> sites = {
        {0, 1, .30F},  {1, 0, .25F},  {1, 1, -.05F}, {1, -1, .05F}, {0, 2, .05F},
        {2, 0, .05F},  {1, 2, -.02F}, {1, -2, .02F}, {2, 1, -.02F}, {2, -1, .02F},
        {2, 2, -.01F}, {2, -2, .01F}, {0, 3, .02F},  {3, 0, .02F}};
    const auto first = [&](std::ptrdiff_t taps) {
        return std::vector<sateen::CausalTap>(sites.begin(), sites.begin() + taps);
    };
    const auto separable = [](float rho) {
        return std::vector<sateen::CausalTap>{
            {0, 1, rho}, {1, 0, rho}, {1, 1, -rho * rho}};
    };
    return {{"3", first(3)},
            {"4", first(4)},
            {"10", first(10)},
            {"14", first(14)},
            {"3, correlation 0.6", separable(.6F)},
            {"3, correlation 0.9", separable(.9F)}};
}

// Processor time of a call, in seconds: unlike the clock on the wall it does not count
// being descheduled.
template <class Work>
double processor_time(Work&& work) {
    const std::clock_t start = std::clock();
    work();
    return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

// Calls body(noise field, side) for the planes and levels.
template <class Body>
void for_each_field(Body&& body) {
    for (std::size_t k = 0; k < kLevels; ++k) {
        for (std::uint32_t plane = 0; plane < kPlanes; ++plane) {
            body(sateen::NoiseField{0, static_cast<std::uint32_t>(k) * kPlanes + plane},
                 kSize >> k);
        }
    }
}

double time_noise(sateen::Image& planes) {
    return processor_time([&] {
        for_each_field([&](sateen::NoiseField noise, std::size_t side) {
            const auto plane = planes.plane(noise.band % kPlanes);
            for (std::size_t r = 0; r < side; ++r) {
                sateen::draw_normals(noise, static_cast<std::int32_t>(r), 0,
                                     {plane.row(r), side});
            }
        });
    });
}

double time_rows(const std::vector<sateen::CausalTap>& taps) {
    return processor_time([&] {
        for_each_field([&](sateen::NoiseField noise, std::size_t side) {
            auto recursion = sateen::CausalRecursion::create(taps, 0.8F, side);
            if (!recursion) std::abort();
            for (std::size_t r = 0; r < side; ++r) {
                sateen::draw_normals(noise, static_cast<std::int32_t>(r), 0,
                                     recursion->noise());
                (void)recursion->next_row();
            }
        });
    });
}

sateen::RecursiveField recursive_field(const std::vector<sateen::CausalTap>& taps) {
    sateen::Car2d car;
    car.variance = 0.64F;
    for (const sateen::CausalTap& tap : taps) {
        car.neighbourhood.push_back(
            {static_cast<std::int8_t>(tap.row), static_cast<std::int8_t>(tap.col)});
        car.a.push_back(tap.a);
    }
    std::vector<sateen::Level> levels(kLevels);
    for (sateen::Level& level : levels) level.fields = {car};
    auto field = sateen::RecursiveField::create({levels, 0, 0, 0});
    if (!field) std::abort();
    return *std::move(field);
}

double time_texture(const sateen::RecursiveField& field, sateen::Image& texture) {
    sateen::SerialExecutor serial;
    return processor_time([&] {
        for (std::uint32_t plane = 0; plane < kPlanes; ++plane) {
            if (!field.draw(0, plane, 0, 0, texture.plane(plane), serial)) std::abort();
        }
    });
}

}  // namespace

int main() {
    std::printf("{\"bench\": \"causal_recursion\", \"size\": %zu, \"taps\": {", kSize);
    const char* separator = "";
    for (const Model& model : models()) {
        const sateen::RecursiveField field = recursive_field(model.taps);
        sateen::Image texture(kPlanes, kSize, kSize);
        double noise = std::numeric_limits<double>::infinity();
        double rows = noise;
        double whole = noise;
        for (int i = 0; i < kRepeats; ++i) {
            noise = std::min(noise, time_noise(texture));
            rows = std::min(rows, time_rows(model.taps));
            whole = std::min(whole, time_texture(field, texture));
        }
        std::printf(
            "%s\"%s\": {\"noise_ms\": %.2f, \"rows_ms\": %.2f, \"texture_ms\": %.2f, "
            "\"rows_to_noise\": %.2f, \"texture_to_noise\": %.2f}",
            separator, model.name, 1e3 * noise, 1e3 * rows, 1e3 * whole, rows / noise,
            whole / noise);
        separator = ", ";
    }
    std::printf("}, \"limit_texture_to_noise\": 2.5}\n");
}

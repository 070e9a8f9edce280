// SPDX-License-Identifier: Apache-2.0
// Makes a small measurement in the UBO2003 layout: a hammered, rusty sheet of metal under
// 25 views and 25 lights. It shows what a measurement folder looks like, and feeds
// ./demo.
//
//     make_measurement FOLDER
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <numbers>
#include <string>
#include <vector>

#include "sateen/core/direction.hpp"
#include "sateen/core/image.hpp"
#include "sateen/core/normal.hpp"
#include "sateen/core/result.hpp"
#include "sateen/io/image_file.hpp"

namespace {

using Vector = std::array<float, 3>;

constexpr std::size_t kSide = 128;

float dot(const Vector& a, const Vector& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

Vector normalised(Vector v) {
    const float length = std::sqrt(dot(v, v));
    return {v[0] / length, v[1] / length, v[2] / length};
}

/// Toroidal Gaussian noise, blurred so that its features are about `blur` pixels wide.
sateen::Image smooth_noise(std::uint32_t band, int blur) {
    sateen::Image noise(1, kSide, kSide);
    for (std::size_t r = 0; r < kSide; ++r)
        sateen::draw_normals({7, band}, static_cast<std::int32_t>(r), 0,
                             {noise.plane(0).row(r), kSide});
    for (int pass = 0; pass < 2 * blur; ++pass) {
        sateen::Image next(1, kSide, kSide);
        for (std::size_t r = 0; r < kSide; ++r)
            for (std::size_t c = 0; c < kSide; ++c)
                next(0, r, c) = 0.2F * (noise(0, r, c) + noise(0, (r + 1) % kSide, c) +
                                        noise(0, (r + kSide - 1) % kSide, c) +
                                        noise(0, r, (c + 1) % kSide) +
                                        noise(0, r, (c + kSide - 1) % kSide));
        noise = next;
    }
    float sum = 0;
    for (const float v : noise.values()) sum += v * v;
    const float scale = 1 / std::sqrt(sum / static_cast<float>(kSide * kSide));
    for (float& v : noise.values()) v *= scale;
    return noise;
}

/// The sheet: unit normals of a bumpy height field, and rust from 0 to 1.
struct Sheet {
    sateen::Image dents = smooth_noise(0, 5);
    sateen::Image pores = smooth_noise(1, 1);
    sateen::Image stain = smooth_noise(2, 6);
    sateen::Image grain = smooth_noise(3, 0);

    [[nodiscard]] float height(std::size_t r, std::size_t c) const {
        return dents(0, r, c) + 0.25F * pores(0, r, c);
    }

    [[nodiscard]] Vector normal(std::size_t r, std::size_t c) const {
        constexpr float kRelief_px = 0.6F;
        const float p = height(r, (c + 1) % kSide) - height(r, (c + kSide - 1) % kSide);
        // Rows go down while y goes up.
        const float q = height((r + kSide - 1) % kSide, c) - height((r + 1) % kSide, c);
        return normalised({-kRelief_px * p / 2, -kRelief_px * q / 2, 1});
    }
};

/// Rust is a Lambertian brown, bare metal a broad Blinn-Phong highlight; cosine included.
Vector shade(const Sheet& sheet, std::size_t r, std::size_t c, const Vector& light,
             const Vector& view) {
    const Vector n = sheet.normal(r, c);
    const float cosine = std::max(0.0F, dot(n, light));
    const Vector half =
        normalised({light[0] + view[0], light[1] + view[1], light[2] + view[2]});
    const float gloss = std::pow(std::max(0.0F, dot(n, half)), 12.0F);
    const float rust =
        1 / (1 + std::exp(-2 * (sheet.stain(0, r, c) + sheet.grain(0, r, c))));
    const Vector brown = {0.30F, 0.13F, 0.06F};
    const Vector metal = {0.42F, 0.40F, 0.37F};
    Vector colour{};
    for (std::size_t band = 0; band < 3; ++band) {
        const float diffuse = rust * brown[band] + (1 - rust) * 0.25F * metal[band];
        colour[band] = cosine * (diffuse + (1 - rust) * metal[band] * gloss);
    }
    return colour;
}

std::vector<std::array<int, 2>> directions_deg() {
    std::vector<std::array<int, 2>> result = {{0, 0}};
    for (const int theta : {30, 60})
        for (int phi = 0; phi < 360; phi += 30) result.push_back({theta, phi});
    return result;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 2) {
        std::fprintf(stderr, "usage: make_measurement FOLDER\n");
        return 2;
    }
    const Sheet sheet;
    const auto directions = directions_deg();
    for (const auto& view : directions) {
        std::array<char, 64> folder{};
        std::snprintf(folder.data(), folder.size(), "tv%03d_pv%03d", view[0], view[1]);
        const std::filesystem::path path = std::filesystem::path(argv[1]) / folder.data();
        std::error_code failure;
        std::filesystem::create_directories(path, failure);
        for (std::size_t k = 0; k < directions.size(); ++k) {
            const auto& light = directions[k];
            const auto to = [](const std::array<int, 2>& deg) {
                return sateen::to_vector(sateen::direction_from_degrees(
                    static_cast<float>(deg[0]), static_cast<float>(deg[1])));
            };
            sateen::Image image(3, kSide, kSide);
            for (std::size_t r = 0; r < kSide; ++r)
                for (std::size_t c = 0; c < kSide; ++c) {
                    const Vector colour = shade(sheet, r, c, to(light), to(view));
                    for (std::size_t band = 0; band < 3; ++band)
                        image(band, r, c) = 1.4F * colour[band];
                }
            std::array<char, 96> name{};
            std::snprintf(name.data(), name.size(), "tl%03d pl%03d tv%03d pv%03d.jpg",
                          light[0], light[1], view[0], view[1]);
            const sateen::Result<void> written =
                sateen::write_image((path / name.data()).string(), image.view());
            if (!written) {
                std::fprintf(stderr, "make_measurement: error: %s\n",
                             written.error().message.c_str());
                return 1;
            }
        }
    }
    return 0;
}

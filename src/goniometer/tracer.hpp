// SPDX-License-Identifier: Apache-2.0
// What one view of a surface meets, and what a light makes of it.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "goniometer/height_scene.hpp"
#include "sateen/core/direction.hpp"
#include "sateen/core/parallel.hpp"
#include "sateen/core/result.hpp"
#include "sateen/goniometer/surface_maps.hpp"

namespace sateen::goniometer {

/// Points of the surface that rays met, moved into the period; 16 together. Beyond
/// `count` the last block is filled with points that no light reaches.
struct Hits {
    struct Block {
        Lanes point;
        Lanes normal;
        Lanes colour;
        std::array<float, kLanes> alpha{};
        std::array<float, kLanes> roughness{};
        LaneMask met{};
    };
    std::size_t count = 0;
    std::vector<Block> blocks;
};

/// π f n·l V of 16 points, by band.
using Reflected = std::array<std::array<float, kLanes>, 3>;

/// The layer on top of the body.
struct Layer {
    bool specular = true;
    float f0 = 0.04F;
};

class Tracer {
  public:
    /// \param surface  valid; mean height 0, with normals
    /// \param reach    as of HeightScene
    [[nodiscard]] static Result<Tracer> create(const SurfaceMaps& surface, float width,
                                               float depth, float reach);

    /// Where rays along `view` through points (x, y) of the mean plane meet the surface.
    [[nodiscard]] Hits trace(std::span<const float> x, std::span<const float> y,
                             Direction view, Executor& executor) const;

    /// Which points of a block see a light, or a view: those turned to it from which
    /// nothing is in the way. \param shadows  false: all that are turned to it
    [[nodiscard]] LaneMask lit(const Hits::Block& block, const Vector& direction,
                               bool shadows) const;

    /// Distance to what is in the way along `direction`; infinite for nothing.
    [[nodiscard]] std::array<float, kLanes> free_path(const Hits::Block& block,
                                                      const Vector& direction,
                                                      const LaneMask& mask) const;

    /// Coordinates in the period: x in [0, width), y in (-depth, 0].
    [[nodiscard]] float wrap_x(float x) const;
    [[nodiscard]] float wrap_y(float y) const;

  private:
    explicit Tracer(HeightScene scene) : scene_(std::move(scene)) {}
    void look_up(Hits::Block& block, std::size_t lane) const;
    [[nodiscard]] Lanes lifted(const Hits::Block& block) const;

    /// One texel: normal, colour, roughness.
    using Texel = std::array<float, 8>;

    HeightScene scene_;
    std::vector<Texel> texels_;
    std::size_t rows_ = 0;
    std::size_t cols_ = 0;
    float width_ = 0;
    float depth_ = 0;
    float lowest_ = 0;
    float highest_ = 0;
    float lift_ = 0;
};

/// π f n·l of the points of a block, where `mask` says that they are lit; 0 elsewhere.
[[nodiscard]] Reflected reflect(const Hits::Block& block, const Layer& layer,
                                const Vector& view, const Vector& light,
                                const LaneMask& mask);

}  // namespace sateen::goniometer

// SPDX-License-Identifier: Apache-2.0
// Two images side by side, and the subspaces of a material beside their measurement.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "sateen/analysis/quality.hpp"
#include "sateen/core/image.hpp"
#include "sateen/core/parallel.hpp"
#include "sateen/core/progress.hpp"
#include "sateen/core/result.hpp"
#include "sateen/material/material.hpp"
#include "sateen/measurement/measurement.hpp"

namespace sateen::cli {

/// Two images and how near they are.
struct Comparison {
    std::string title;  ///< e.g. the subspace; may be empty
    std::string reference_name;
    std::string candidate_name;
    Image reference;
    Image candidate;
    TextureScore score;
    TextureCrossCheck cross_check;
    SeamRatio seam;  ///< of the candidate
};

/// An image and its name.
struct NamedImage {
    std::string name;
    Image image;
};

[[nodiscard]] Result<Comparison> compare_images(std::string title, NamedImage reference,
                                                NamedImage candidate, Executor& executor);

/// A texture of every subspace, of the size of the image that it was modelled from, beside
/// that image. \error where the measurement lacks a representative; cancelled
[[nodiscard]] Result<std::vector<Comparison>> compare_subspaces(
    const Material& material, const std::string& material_name,
    const Measurement& measurement, std::uint64_t seed, Executor& executor,
    Progress& progress);

/// Of the total scores.
[[nodiscard]] double geometric_mean(const std::vector<Comparison>& comparisons);

}  // namespace sateen::cli

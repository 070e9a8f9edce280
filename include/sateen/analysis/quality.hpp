// SPDX-License-Identifier: Apache-2.0
// Texture similarity without learned weights: how far one picture of a material is from
// another, in units of how far two pieces of the same picture are from each other.
// Theory: docs/theory/quality.md.
#pragma once

#include <array>
#include <cstddef>
#include <memory>

#include "sateen/core/image.hpp"
#include "sateen/core/parallel.hpp"
#include "sateen/core/result.hpp"

namespace sateen {

/// One of the five measures of texture similarity.
struct TextureComponent {
    /// max(1, distance / spread) with both taken group by group; 1 is as close as two
    /// disjoint pieces of the reference, 2 twice as far.
    double score = 1;
    /// Root mean square distance between pieces of the candidate and of the reference.
    /// Units: ΔE for colour, nepers for power, variances for autocovariance, else none.
    double distance = 0;
    /// The same between disjoint pieces of the reference.
    double spread = 0;
};

/// Similarity of a candidate to a reference.
struct TextureScore {
    TextureComponent colour;          ///< sliced Wasserstein distance in Lab
    TextureComponent power;           ///< power spectrum by ring and sector
    TextureComponent autocovariance;  ///< by lag, up to a quarter of a piece
    TextureComponent subbands;        ///< marginals of steerable pyramid bands
    TextureComponent joint;           ///< correlations of magnitudes between bands
    /// Geometric mean of the five scores.
    double total = 1;

    std::size_t piece_rows = 0;
    std::size_t piece_cols = 0;
    std::size_t reference_pieces = 0;
    std::size_t candidate_pieces = 0;
};

/// What a reference is prepared for.
struct TextureReferenceOptions {
    /// The size of the candidates to come, 0 for that of the reference. Candidates of
    /// another size are scored the same, but the reference is prepared anew for each.
    std::size_t candidate_rows = 0;
    std::size_t candidate_cols = 0;
};

/// A photograph prepared for scoring any number of textures that imitate it.
class TextureReference {
  public:
    /// Each side of an image must have at least this many pixels.
    static constexpr std::size_t kMinSide = 32;

    /// \param reference  (1 or 3, rows, cols), linear; one band stands for grey
    /// \error invalid_argument  another number of bands, a side below kMinSide, or values
    ///                          that are not finite
    /// \cost 0.5 s for 800 x 800 on one thread; four or more pieces in parallel
    [[nodiscard]] static Result<TextureReference> create(
        const Image& reference, const TextureReferenceOptions& options,
        Executor& executor);
    TextureReference(TextureReference&&) noexcept;
    TextureReference& operator=(TextureReference&&) noexcept;
    ~TextureReference();

    /// Scores a candidate. Pieces of equal size are compared: half a side of the smaller
    /// of the two images, or a little less.
    /// \error invalid_argument  as for create()
    [[nodiscard]] Result<TextureScore> compare(const Image& candidate,
                                               Executor& executor) const;

  private:
    struct Prepared;
    explicit TextureReference(std::unique_ptr<const Prepared> prepared);
    std::unique_ptr<const Prepared> prepared_;
};

/// Numbers to check a score by, which no model is fitted to and no score is made of.
/// 0 is equality.
struct TextureCrossCheck {
    /// Mean |log ratio| of the kurtosis of differences, 3 scales by 2 axes: edges lost.
    double gradient_kurtosis = 0;
    /// Distance of the area histograms of the blobs made by the 20 % darkest and the 20 %
    /// brightest pixels, octaves of area.
    double blob = 0;
    /// Sliced Wasserstein distance of mean-free 5 x 5 patches, mean of 3 scales, in
    /// standard deviations of the reference's lightness.
    double patches = 0;
};

/// \error invalid_argument  as for TextureReference::create()
[[nodiscard]] Result<TextureCrossCheck> cross_check(const Image& reference,
                                                    const Image& candidate);

/// Mean |difference| across the wrap divided by mean |neighbour difference|; 1 is
/// seamless, and 0 / 0 counts as seamless.
struct SeamRatio {
    double rows = 1;  ///< last row against first
    double cols = 1;  ///< last column against first
};
[[nodiscard]] SeamRatio seam_ratio(ImageView<const float> image);

}  // namespace sateen

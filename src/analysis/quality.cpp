// SPDX-License-Identifier: Apache-2.0
#include "sateen/analysis/quality.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "analysis/quality_parts.hpp"
#include "analysis/quality_pyramid.hpp"

namespace sateen {
namespace {

using quality::ColourBasis;
using quality::Features;
using quality::Group;
using quality::kPlanes;
using quality::SpectrumGrid;
using quality::SteerableBands;
using quality::SteerablePyramid;

constexpr std::size_t kComponents = 5;

struct PieceSize {
    std::size_t rows = 0;
    std::size_t cols = 0;
    std::size_t levels = 0;
    friend bool operator==(const PieceSize&, const PieceSize&) = default;
};

// The largest size within the limits that the transforms and the pyramid accept.
PieceSize piece_size(std::size_t rows, std::size_t cols) {
    const std::size_t levels = SteerablePyramid::levels_for(rows, cols);
    const std::size_t multiple = std::size_t{2} << levels;
    return {fft_size_at_most(rows, multiple), fft_size_at_most(cols, multiple), levels};
}

// Half the smaller image a side, so that both hold at least four pieces.
PieceSize common_piece_size(std::size_t rows_a, std::size_t cols_a, std::size_t rows_b,
                            std::size_t cols_b) {
    const auto half = [](std::size_t a, std::size_t b) {
        return std::max(std::min(a, b), TextureReference::kMinSide) / 2;
    };
    return piece_size(half(rows_a, rows_b), half(cols_a, cols_b));
}

struct Corner {
    std::size_t row = 0;
    std::size_t col = 0;
};

// `count` positions a piece can take along one side, first and last flush with the ends.
std::size_t position(std::size_t index, std::size_t count, std::size_t side,
                     std::size_t piece) {
    return count == 1 ? (side - piece) / 2 : index * (side - piece) / (count - 1);
}

// Pieces that do not overlap, spread over the whole.
std::vector<Corner> place_pieces(std::size_t rows, std::size_t cols, PieceSize piece) {
    constexpr std::size_t kMost = 3;
    const std::size_t down = std::min(kMost, rows / piece.rows);
    const std::size_t across = std::min(kMost, cols / piece.cols);
    std::vector<Corner> corners;
    for (std::size_t i = 0; i < down; ++i) {
        for (std::size_t j = 0; j < across; ++j) {
            corners.push_back({position(i, down, rows, piece.rows),
                               position(j, across, cols, piece.cols)});
        }
    }
    return corners;
}

/// What all pieces of one size are read with.
struct PieceTools {
    SteerablePyramid pyramid;
    SpectrumGrid grid;
};

using PieceFeatures = std::array<Features, kComponents>;

Result<PieceFeatures> describe(const Image& planes, const ColourBasis& basis,
                               Corner corner, PieceSize piece, const PieceTools& tools) {
    PieceFeatures features;
    auto& [colour, power, autocovariance, subbands, joint] = features;
    quality::add_colour(planes.view(), corner.row, corner.col, piece.rows, piece.cols,
                        colour);
    std::vector<SteerableBands> bands;
    std::vector<double> weights;
    for (std::size_t p = 0; p < kPlanes; ++p) {
        if (basis.weight[p] == 0) continue;
        const auto window =
            planes.plane(p).window(corner.row, corner.col, piece.rows, piece.cols);
        SATEEN_TRY(const SplitComplexPlane spectrum,
                   quality::periodic_spectrum(window, tools.pyramid.fft()));
        const SplitComplexPlane tapered =
            quality::tapered_spectrum(window, tools.grid, tools.pyramid.fft());
        quality::add_power(tapered, tools.grid, basis.weight[p], power);
        quality::add_autocovariance(tapered, tools.grid, tools.pyramid.fft(),
                                    basis.weight[p], autocovariance);
        bands.push_back(tools.pyramid.decompose(spectrum));
        weights.push_back(basis.weight[p]);
    }
    quality::add_subbands(bands, weights, subbands);
    quality::add_joint(bands, weights, joint);
    return features;
}

Result<std::vector<PieceFeatures>> describe_all(const Image& planes,
                                                const ColourBasis& basis,
                                                const std::vector<Corner>& corners,
                                                PieceSize piece, const PieceTools& tools,
                                                Executor& executor) {
    std::vector<std::optional<Result<PieceFeatures>>> results(corners.size());
    parallel_for(executor, corners.size(), [&](std::size_t i) {
        results[i].emplace(describe(planes, basis, corners[i], piece, tools));
    });
    std::vector<PieceFeatures> all;
    for (auto& result : results) {
        SATEEN_TRY(PieceFeatures features, *std::move(result));
        all.push_back(std::move(features));
    }
    return all;
}

// Mean square difference of the features of one group.
double group_distance_sq(const Features& a, const Features& b, const Group& group) {
    double sum = 0;
    for (std::size_t i = group.first; i < group.first + group.count; ++i) {
        const double difference =
            static_cast<double>(a.values()[i]) - static_cast<double>(b.values()[i]);
        sum += difference * difference;
    }
    return sum / static_cast<double>(std::max<std::size_t>(group.count, 1));
}

/// Pieces of the reference of one size, and how far they are from each other.
struct Pieces {
    PieceSize size;
    std::optional<PieceTools> tools;
    std::vector<PieceFeatures> features;
    /// Per component and group, mean square distance between two disjoint pieces.
    std::array<std::vector<double>, kComponents> spread_sq;
};

std::vector<double> spread_of(const std::vector<PieceFeatures>& pieces,
                              std::size_t component) {
    std::vector<double> spread;
    for (const Group& group : pieces.front()[component].groups()) {
        double sum = 0;
        double pairs = 0;
        for (std::size_t i = 0; i < pieces.size(); ++i) {
            for (std::size_t j = i + 1; j < pieces.size(); ++j) {
                sum +=
                    group_distance_sq(pieces[i][component], pieces[j][component], group);
                pairs += 1;
            }
        }
        spread.push_back(pairs > 0 ? sum / pairs : 0.0);
    }
    return spread;
}

Result<Pieces> prepare_pieces(const Image& planes, const ColourBasis& basis,
                              PieceSize size, Executor& executor) {
    Pieces pieces;
    pieces.size = size;
    SATEEN_TRY(SteerablePyramid pyramid,
               SteerablePyramid::create(size.rows, size.cols, size.levels));
    pieces.tools.emplace(
        PieceTools{std::move(pyramid), SpectrumGrid(size.rows, size.cols)});
    const auto corners = place_pieces(planes.rows(), planes.cols(), size);
    SATEEN_TRY(pieces.features,
               describe_all(planes, basis, corners, size, *pieces.tools, executor));
    for (std::size_t k = 0; k < kComponents; ++k) {
        pieces.spread_sq[k] = spread_of(pieces.features, k);
    }
    return pieces;
}

// Two pieces of one texture are at a mean square distance spread² = 2V, V the variance of
// a feature over pieces; a piece of the reference and one of the candidate at
// δ² + V + V_c, where δ is how far the means are apart. V_c is replaced by V, so that a
// candidate more uniform than a photograph gains nothing by it:
//
//     score² = Σ_g w_g (1 + max(0, δ_g²) / (spread_g² + floor_g²))
TextureComponent compare_component(const Pieces& reference,
                                   const std::vector<PieceFeatures>& candidate,
                                   std::size_t component) {
    const auto& groups = reference.features.front()[component].groups();
    const auto pairs = static_cast<double>(reference.features.size()) *
                       static_cast<double>(candidate.size());
    const std::vector<double> candidate_spread = spread_of(candidate, component);
    double score_sq = 0;
    double distance_sq = 0;
    double spread_sq = 0;
    for (std::size_t g = 0; g < groups.size(); ++g) {
        const Group& group = groups[g];
        double sum = 0;
        for (const PieceFeatures& r : reference.features) {
            for (const PieceFeatures& c : candidate) {
                sum += group_distance_sq(r[component], c[component], group);
            }
        }
        const double spread = reference.spread_sq[component][g];
        const double excess =
            std::max(0.0, sum / pairs - 0.5 * (spread + candidate_spread[g]));
        score_sq += group.weight * (1 + excess / (spread + group.floor * group.floor));
        distance_sq += group.weight * (spread + excess);
        spread_sq += group.weight * spread;
    }
    return {std::max(1.0, std::sqrt(score_sq)), std::sqrt(distance_sq),
            std::sqrt(spread_sq)};
}

}  // namespace

struct TextureReference::Prepared {
    ColourBasis basis;
    Image planes;
    Pieces pieces;
};

TextureReference::TextureReference(std::unique_ptr<const Prepared> prepared)
    : prepared_(std::move(prepared)) {}
TextureReference::TextureReference(TextureReference&&) noexcept = default;
TextureReference& TextureReference::operator=(TextureReference&&) noexcept = default;
TextureReference::~TextureReference() = default;

Result<TextureReference> TextureReference::create(const Image& reference,
                                                  const TextureReferenceOptions& options,
                                                  Executor& executor) {
    SATEEN_CHECK(quality::check_image(reference, "reference"));
    auto prepared = std::make_unique<Prepared>();
    prepared->basis = quality::estimate_basis(reference);
    prepared->planes = quality::to_planes(reference, prepared->basis);
    const std::size_t rows =
        options.candidate_rows > 0 ? options.candidate_rows : reference.rows();
    const std::size_t cols =
        options.candidate_cols > 0 ? options.candidate_cols : reference.cols();
    SATEEN_TRY(
        prepared->pieces,
        prepare_pieces(prepared->planes, prepared->basis,
                       common_piece_size(reference.rows(), reference.cols(), rows, cols),
                       executor));
    return TextureReference(std::move(prepared));
}

Result<TextureScore> TextureReference::compare(const Image& candidate,
                                               Executor& executor) const {
    SATEEN_CHECK(quality::check_image(candidate, "candidate"));
    const ColourBasis& basis = prepared_->basis;
    const Image planes = quality::to_planes(candidate, basis);

    const Pieces* reference = &prepared_->pieces;
    Pieces other;
    const PieceSize size = common_piece_size(
        prepared_->planes.rows(), prepared_->planes.cols(), planes.rows(), planes.cols());
    if (size != reference->size) {
        SATEEN_TRY(other, prepare_pieces(prepared_->planes, basis, size, executor));
        reference = &other;
    }
    const auto corners = place_pieces(planes.rows(), planes.cols(), size);
    SATEEN_TRY(const auto pieces,
               describe_all(planes, basis, corners, size, *reference->tools, executor));

    TextureScore score;
    score.piece_rows = size.rows;
    score.piece_cols = size.cols;
    score.reference_pieces = reference->features.size();
    score.candidate_pieces = pieces.size();
    const std::array<TextureComponent*, kComponents> components = {
        &score.colour, &score.power, &score.autocovariance, &score.subbands,
        &score.joint};
    double log_sum = 0;
    for (std::size_t k = 0; k < kComponents; ++k) {
        *components[k] = compare_component(*reference, pieces, k);
        log_sum += std::log(components[k]->score);
    }
    score.total = std::exp(log_sum / kComponents);
    return score;
}

}  // namespace sateen

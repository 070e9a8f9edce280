// SPDX-License-Identifier: Apache-2.0
// The parts of the texture similarity: each turns a piece of an image into a vector, so
// that every distance is Euclidean. Theory: docs/theory/quality.md.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "sateen/core/fft.hpp"
#include "sateen/core/image.hpp"
#include "sateen/core/result.hpp"

namespace sateen::quality {

inline constexpr std::size_t kPlanes = 3;

/// Contrast nobody sees in a texture, as the standard deviation of white noise, ΔE. Every
/// ratio of amplitudes is taken above it, so that quantisation noise and empty planes
/// count for nothing.
inline constexpr double kInvisible = 0.25;

/// The planes both images are compared in: the K-L planes of the reference in Lab.
struct ColourBasis {
    float exposure = 1;
    std::array<float, 3> mean{};
    std::array<std::array<float, 3>, kPlanes> axes{};  ///< rows are eigenvectors
    std::array<double, kPlanes> deviation{};           ///< ΔE, decreasing
    std::array<double, kPlanes> weight{};              ///< sum 1; 0 where invisible
};

[[nodiscard]] Result<void> check_image(const Image& image, const char* role);
[[nodiscard]] ColourBasis estimate_basis(const Image& linear);
/// (3, rows, cols): axes (Lab(exposure x) - mean).
[[nodiscard]] Image to_planes(const Image& linear, const ColourBasis& basis);
/// (3, rows, cols): Lab of the exposed image.
[[nodiscard]] Image to_lab(const Image& linear, float exposure);
/// CIE lightness of the exposed image.
[[nodiscard]] Image to_lightness(const Image& linear, float exposure);
[[nodiscard]] float choose_exposure(const Image& linear);

/// Features whose spread is estimated together. Their squared differences are averaged.
struct Group {
    std::size_t first = 0;
    std::size_t count = 0;
    double weight = 0;  ///< in the component; weights sum to 1
    double floor = 0;   ///< least spread, in the units of the features
};

/// A vector of features in groups.
class Features {
  public:
    void begin_group(double weight, double floor) {
        groups_.push_back({values_.size(), 0, weight, floor});
    }
    void add(double value) {
        values_.push_back(static_cast<float>(value));
        ++groups_.back().count;
    }
    [[nodiscard]] const std::vector<Group>& groups() const { return groups_; }
    [[nodiscard]] const std::vector<float>& values() const { return values_; }

  private:
    std::vector<float> values_;
    std::vector<Group> groups_;
};

/// Quantile functions of projections of the colours on fixed directions: the Euclidean
/// distance of two is the sliced 2-Wasserstein distance, a shift by v giving |v|.
void add_colour(ImageView<const float> planes, std::size_t row, std::size_t col,
                std::size_t rows, std::size_t cols, Features& features);

/// A cosine taper over the first and the last quarter of a side, which keeps the sharp
/// lines of a weave from leaking over the spectrum.
struct Taper {
    explicit Taper(std::size_t length);
    /// Σ gain(i) gain(i + lag) on the circle.
    [[nodiscard]] double overlap(std::size_t lag) const;

    std::vector<float> gain;
    double energy = 0;  ///< Σ gain²
};
/// What the spectra of all pieces of one size are read with: the tapers, and cells of
/// half an octave by an eighth of a half turn, fine enough for a weave's direction,
/// coarse enough that most average many bins. Rings start at three periods a piece:
/// below, one piece cannot tell texture from uneven light.
struct SpectrumGrid {
    static constexpr std::size_t kSectors = 8;
    static constexpr std::uint16_t kNoCell = 0xFFFF;

    SpectrumGrid(std::size_t rows, std::size_t cols);

    Taper down;
    Taper across;
    std::size_t rings = 0;
    std::vector<std::uint16_t> cell;  ///< of each bin of the half spectrum
    std::vector<double> bins;         ///< in each cell
};

/// Half spectrum, unnormalised, of the periodic component of a plane.
[[nodiscard]] Result<SplitComplexPlane> periodic_spectrum(PlaneView<const float> plane,
                                                          const Fft2d& fft);
/// Half spectrum, unnormalised, of the tapered plane less its mean.
[[nodiscard]] SplitComplexPlane tapered_spectrum(PlaneView<const float> plane,
                                                 const SpectrumGrid& grid,
                                                 const Fft2d& fft);
/// Log power by ring and sector, of a tapered spectrum.
void add_power(const SplitComplexPlane& spectrum, const SpectrumGrid& grid, double weight,
               Features& features);
/// Autocovariance over the variance, in annuli of lag one octave wide.
void add_autocovariance(const SplitComplexPlane& spectrum, const SpectrumGrid& grid,
                        const Fft2d& fft, double weight, Features& features);

}  // namespace sateen::quality

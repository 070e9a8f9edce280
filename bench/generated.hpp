// SPDX-License-Identifier: Apache-2.0
// A photograph made in code, and its material.
#pragma once

#include <cstdio>
#include <cstdlib>
#include <string>
#include <utility>

#include "sateen/analysis/analyse.hpp"
#include "sateen/measurement/measurement.hpp"
#include "support/textures.hpp"

namespace sateen::bench {

/// Benchmarks have no use for an error but to end.
template <class T>
T value_or_exit(Result<T> result) {
    if (result) return *std::move(result);
    std::fprintf(stderr, "bench: error: %s\n", result.error().message.c_str());
    std::exit(1);
}

inline void check_or_exit(const Result<void>& result) {
    if (result) return;
    std::fprintf(stderr, "bench: error: %s\n", result.error().message.c_str());
    std::exit(1);
}

/// One photograph in memory: of overlapping discs, or what is given.
class GeneratedPhotograph final : public Measurement {
  public:
    GeneratedPhotograph(std::size_t rows, std::size_t cols)
        : GeneratedPhotograph("discs", test::discs(rows, cols, 1)) {}
    GeneratedPhotograph(const std::string& name, Image image) : image_(std::move(image)) {
        info_.name = name;
        info_.layout = "photograph";
        info_.rows = image_.rows();
        info_.cols = image_.cols();
        info_.bands = image_.bands();
        info_.observations.resize(1);
        info_.observations[0].name = name;
    }
    [[nodiscard]] const MeasurementInfo& info() const override { return info_; }
    [[nodiscard]] Result<Image> read(std::size_t) const override { return image_; }

  private:
    Image image_;
    MeasurementInfo info_;
};

/// The material of such a photograph, its one subspace repeated; of Gaussian fields, whose
/// cost is what most benchmarks are about.
inline Material generated_material(std::size_t subspaces, AnalysisOptions options = {},
                                   bool modulated = false) {
    options.modulation = modulated;
    const GeneratedPhotograph photograph(512, 512);
    SerialExecutor executor;
    Progress progress;
    Material material =
        value_or_exit(analyse(photograph, options, executor, progress)).material;
    material.subspaces.resize(subspaces, material.subspaces.front());
    return material;
}

}  // namespace sateen::bench

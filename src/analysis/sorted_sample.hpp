// SPDX-License-Identifier: Apache-2.0
// A sample in order: its quantiles and ranks.
#pragma once

#include <cstddef>
#include <vector>

namespace sateen {

class SortedSample {
  public:
    /// \param values  finite, at least one
    /// \cost  three passes over the values
    explicit SortedSample(std::vector<float> values);

    /// Linear between the values, p in [0, 1].
    [[nodiscard]] double quantile(double p) const;
    /// F(x): the share of values below x, counting half of one for x itself.
    [[nodiscard]] double rank(double x) const;

  private:
    std::vector<float> values_;
};

}  // namespace sateen

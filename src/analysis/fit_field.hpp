// SPDX-License-Identifier: Apache-2.0
// The field of one level: which model, which neighbourhood, which coefficients.
// Theory: docs/theory/field_choice.md.
#pragma once

#include <string>
#include <vector>

#include "sateen/analysis/autocovariance.hpp"
#include "sateen/analysis/options.hpp"
#include "sateen/core/image.hpp"
#include "sateen/core/parallel.hpp"
#include "sateen/core/result.hpp"
#include "sateen/material/field_model.hpp"

namespace sateen {

/// Levels of a smaller variance, in units of the plane's, are constant.
inline constexpr double kNegligibleVariance = 1e-10;

/// The field of one plane and level from its covariances, with exactly their variance.
/// FieldKind::automatic: the model of the best Bayesian information, added to `choice`.
[[nodiscard]] Result<FieldModel> fit_field(const Autocovariance& R,
                                           const AnalysisOptions& options,
                                           FieldChoice& choice);

/// The field of one band of the ordinary pyramid, by the estimator that the paper of the
/// model prints; repaired, with a note, where that is not valid.
/// \param place  names the band in notes
[[nodiscard]] Result<FieldModel> fit_field_as_printed(PlaneView<const float> band,
                                                      const AnalysisOptions& options,
                                                      const std::string& place,
                                                      std::vector<std::string>& notes,
                                                      Executor& executor);

/// The field of all planes of one level, car3d or sar3d by the options. Planes that are
/// constant are left out and come back as constants. The Bayesian information of a car3d
/// is added to `choice`.
/// \param place  names the level in notes
[[nodiscard]] Result<FieldModel> fit_joint_field(const CrossAutocovariance& R,
                                                 const AnalysisOptions& options,
                                                 const std::string& place,
                                                 FieldChoice& choice,
                                                 std::vector<std::string>& notes);

}  // namespace sateen

// SPDX-License-Identifier: Apache-2.0
// One row of the pyramid's reduction and expansion, over rows and then over columns.
#pragma once

#include <cstddef>

namespace sateen {

/// What becomes of the values of a row.
enum class Update { assign, add, subtract };

/// line = Σ_a w_a rows[a] of five rows of `count` columns.
void reduce_rows(const float* const rows[5], float* line, std::size_t count);
/// coarse[j] = Σ_b w_b line[2 j + b], b = 0 … 4.
void reduce_columns(const float* line, float* coarse, std::size_t count);

/// One row halfway through its expansion, of an even or odd fine row. Odd ones do not
/// read `above`.
void expand_rows(const float* above, const float* here, const float* below, bool odd,
                 float* line, std::size_t count);
/// Fine columns [x, x + count) from `line`, whose element k is coarse column ⌈x / 2⌉ - 1
/// + k.
void expand_columns(const float* line, bool starts_odd, float* fine, std::size_t count,
                    Update update);

}  // namespace sateen

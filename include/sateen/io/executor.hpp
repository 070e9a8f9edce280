// SPDX-License-Identifier: Apache-2.0
// The native executor: oneTBB behind core's seam.
#pragma once

#include <cstddef>
#include <memory>

#include "sateen/core/parallel.hpp"

namespace sateen {

/// \param threads  0 for as many as the machine has
[[nodiscard]] std::unique_ptr<Executor> make_executor(std::size_t threads);

}  // namespace sateen

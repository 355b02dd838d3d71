// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

// The loop in which Hankel transforms spend their time, compiled for each instruction set and
// chosen at run time. Results differ between processors by rounding only.

namespace lamina::detail {

/// sums[i, c] = sum over j of kernel[i * r_stride + j * k_stride] * rows[j, c], where the kernel
/// is 0 beyond its end.
[[nodiscard]] std::vector<double> correlate(std::span<const double> kernel, std::size_t r_stride,
                                            std::size_t k_stride, std::span<const double> rows,
                                            std::size_t channels, std::size_t r_size);

}  // namespace lamina::detail

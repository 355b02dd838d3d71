// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "lamina/scattering/heterogeneous/blurs/internal/gaussian_blur_grids.h"
#include "lamina/scattering/heterogeneous/blurs/internal/gaussian_blur_kernels.h"
#include "lamina/scattering/heterogeneous/blurs/texel_basis.h"

namespace lamina::detail {

/// The functions of a basis along one row of texels.
class BasisRow {
 public:
  explicit BasisRow(const TexelBasis& basis) : basis_(basis), modes_(basis.modes.size()) {}

  void move_to(int y) {
    if (modes_.empty()) coordinate_ = row_of(basis_.coordinate, y);
    for (std::size_t p = 0; p < modes_.size(); ++p) modes_[p] = row_of(basis_.modes[p], y);
  }

  /// sum[x] += row[x] times the sum of functions by these coefficients.
  void add_times_sum(const float* row, std::span<const float> coefficients, float* sum,
                     std::size_t size) const {
    if (modes_.empty())
      add_times_polynomial(row, coordinate_, coefficients, sum, size);
    else
      add_times_modes(row, modes_, coefficients, sum, size);
  }

  /// sum[x] += sum over p of function_p[x] rows[p][x].
  void add_products(std::span<const float* const> rows, float* sum, std::size_t size) const {
    if (modes_.empty())
      add_polynomial(rows, coordinate_, sum, size);
    else
      lamina::detail::add_products(rows, modes_, sum, size);
  }

 private:
  const TexelBasis& basis_;
  const float* coordinate_ = nullptr;
  std::vector<const float*> modes_;
};

}  // namespace lamina::detail

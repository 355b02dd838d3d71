// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "lamina/solve/scattering/heterogeneous/blurs/internal/gaussian_blur_grids.h"
#include "lamina/solve/scattering/heterogeneous/blurs/internal/gaussian_blur_kernels.h"
#include "lamina/solve/scattering/heterogeneous/blurs/texel_basis.h"

namespace lamina::detail {

/// The functions of a basis along one row of texels.
template <class T>
class BasisRow {
 public:
  explicit BasisRow(const TexelBasisOf<T>& basis) : basis_(basis), modes_(basis.modes.size()) {}

  void move_to(int y) {
    if (modes_.empty()) coordinate_ = row_of(basis_.coordinate, y);
    for (std::size_t p = 0; p < modes_.size(); ++p) modes_[p] = row_of(basis_.modes[p], y);
  }

  /// sum[x] += row[x] times the sum of functions by these coefficients.
  /// @param slope  unless it is null, the same of its derivative by the coordinate; not of modes
  void add_times_sum(const T* row, std::span<const T> coefficients, T* sum, T* slope,
                     std::size_t size) const {
    const BlurKernels<T>& kernels = blur_kernels<T>();
    if (!modes_.empty())
      kernels.add_times_modes(row, modes_, coefficients, sum, size);
    else if (slope == nullptr)
      kernels.add_times_polynomial(row, coordinate_, coefficients, sum, size);
    else
      kernels.add_times_polynomial_and_slope(row, coordinate_, coefficients, sum, slope, size);
  }

  /// sum[x] += sum over p of function_p[x] rows[p][x], and its slope likewise.
  void add_products(std::span<const T* const> rows, T* sum, T* slope, std::size_t size) const {
    const BlurKernels<T>& kernels = blur_kernels<T>();
    if (!modes_.empty())
      kernels.add_products(rows, modes_, sum, size);
    else if (slope == nullptr)
      kernels.add_polynomial(rows, coordinate_, sum, size);
    else
      kernels.add_polynomial_and_slope(rows, coordinate_, sum, slope, size);
  }

  /// row[x] times each function in turn: `take(p, products)`; they are framed, not mirrored.
  template <class Take>
  void for_products(const T* row, std::size_t count, FramedRow<T>& products, std::size_t size,
                    const Take& take) const {
    T* const to = products.data();
    std::copy_n(row, size, to);
    for (std::size_t p = 0; p < count; ++p) {
      if (!modes_.empty())
        blur_kernels<T>().multiply_row(row, modes_[p], to, size);
      else if (p > 0)
        blur_kernels<T>().multiply_row(to, coordinate_, to, size);
      take(p, products);
    }
  }

 private:
  const TexelBasisOf<T>& basis_;
  const T* coordinate_ = nullptr;
  std::vector<const T*> modes_;
};

}  // namespace lamina::detail

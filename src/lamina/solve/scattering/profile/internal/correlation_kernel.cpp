// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/profile/internal/correlation_kernel.h"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "lamina/solve/scattering/profile/internal/correlation_kernel.cpp"
#include <hwy/foreach_target.h>  // compiles this file once per instruction set
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace lamina::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
using D = hn::ScalableTag<double>;
using V = hn::Vec<D>;

/// Four radii at once; `kernel` is padded with zeros for them, `columns` to a multiple of 8.
void correlate_rows(std::span<const double> kernel, std::size_t kernel_end, std::size_t r_stride,
                    std::size_t k_stride, const double* rows, std::size_t k_size,
                    std::size_t columns, double* sums, std::size_t r_size) {
  const D d;
  for (std::size_t i = 0; i < r_size; i += 4) {
    const double* const start = kernel.data() + i * r_stride;
    const std::size_t left = kernel_end > i * r_stride ? kernel_end - i * r_stride : 0;
    const std::size_t last = std::min(k_size, (left + k_stride - 1) / k_stride);
    for (std::size_t c = 0; c < columns; c += hn::Lanes(d)) {
      V a = hn::Zero(d), b = a, e = a, f = a;
      for (std::size_t j = 0; j < last; ++j) {
        const double* const at = start + j * k_stride;
        const V row = hn::LoadU(d, rows + j * columns + c);
        a = hn::MulAdd(hn::Set(d, at[0]), row, a);
        b = hn::MulAdd(hn::Set(d, at[r_stride]), row, b);
        e = hn::MulAdd(hn::Set(d, at[2 * r_stride]), row, e);
        f = hn::MulAdd(hn::Set(d, at[3 * r_stride]), row, f);
      }
      double* const out = sums + i * columns + c;
      hn::StoreU(a, d, out);
      hn::StoreU(b, d, out + columns);
      hn::StoreU(e, d, out + 2 * columns);
      hn::StoreU(f, d, out + 3 * columns);
    }
  }
}

}  // namespace lamina::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace lamina {

HWY_EXPORT(correlate_rows);

std::vector<double> detail::correlate(std::span<const double> kernel, std::size_t r_stride,
                                      std::size_t k_stride, std::span<const double> rows,
                                      std::size_t channels, std::size_t r_size) {
  const std::size_t k_size = rows.size() / channels, columns = (channels + 7) / 8 * 8;
  std::vector<double> wide(k_size * columns, 0.0);
  for (std::size_t j = 0; j < k_size; ++j)
    std::copy_n(&rows[j * channels], channels, &wide[j * columns]);
  const std::size_t r_padded = (r_size + 3) / 4 * 4;
  std::vector<double> all_kernel(kernel.begin(), kernel.end());
  all_kernel.resize(kernel.size() + 4 * r_stride + k_stride, 0.0);
  std::vector<double> sums(r_padded * columns, 0.0);
  HWY_DYNAMIC_DISPATCH(correlate_rows)
  (all_kernel, kernel.size(), r_stride, k_stride, wide.data(), k_size, columns, sums.data(),
   r_padded);
  std::vector<double> result(r_size * channels);
  for (std::size_t i = 0; i < r_size; ++i)
    std::copy_n(&sums[i * columns], channels, &result[i * channels]);
  return result;
}

}  // namespace lamina
#endif

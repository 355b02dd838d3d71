// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/core/internal/row_sums.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "lamina/base/core/internal/row_sums.cpp"
#include <hwy/foreach_target.h>  // compiles this file once per instruction set
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace lamina::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Two registers of at most 8 lanes at a time, so that one addition need not wait for the last.
using Tag = hn::CappedTag<double, 8>;
using Lanes = hn::Vec<Tag>;

void sum_rows_once(const double* rows, std::size_t row_count, std::size_t columns,
                   const double* weights, double* sums) {
  const Tag d;
  const std::size_t n = hn::Lanes(d);
  for (std::size_t c = 0; c < columns; c += 2 * n) {
    Lanes a = hn::Zero(d), b = a;
    const double* row = rows + c;
    for (std::size_t r = 0; r < row_count; ++r, row += columns) {
      const Lanes weight = hn::Set(d, weights[r]);
      a = hn::MulAdd(weight, hn::LoadU(d, row), a);
      b = hn::MulAdd(weight, hn::LoadU(d, row + n), b);
    }
    hn::StoreU(a, d, sums + c);
    hn::StoreU(b, d, sums + c + n);
  }
}

void sum_rows_thrice(const double* rows, std::size_t row_count, std::size_t columns,
                     const double* weights, double* sums, std::size_t stride) {
  const Tag d;
  const std::size_t n = hn::Lanes(d);
  for (std::size_t c = 0; c < columns; c += 2 * n) {
    Lanes a0 = hn::Zero(d), b0 = a0, a1 = a0, b1 = a0, a2 = a0, b2 = a0;
    const double* row = rows + c;
    const double* weight = weights;
    for (std::size_t r = 0; r < row_count; ++r, row += columns, weight += 3) {
      const Lanes a = hn::LoadU(d, row), b = hn::LoadU(d, row + n);
      const Lanes w0 = hn::Set(d, weight[0]), w1 = hn::Set(d, weight[1]),
                  w2 = hn::Set(d, weight[2]);
      a0 = hn::MulAdd(w0, a, a0);
      b0 = hn::MulAdd(w0, b, b0);
      a1 = hn::MulAdd(w1, a, a1);
      b1 = hn::MulAdd(w1, b, b1);
      a2 = hn::MulAdd(w2, a, a2);
      b2 = hn::MulAdd(w2, b, b2);
    }
    double* to = sums + c;
    hn::StoreU(a0, d, to);
    hn::StoreU(b0, d, to + n);
    hn::StoreU(a1, d, to + stride);
    hn::StoreU(b1, d, to + stride + n);
    hn::StoreU(a2, d, to + 2 * stride);
    hn::StoreU(b2, d, to + 2 * stride + n);
  }
}

}  // namespace lamina::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace lamina {

HWY_EXPORT(sum_rows_once);
HWY_EXPORT(sum_rows_thrice);

void detail::sum_rows(const double* rows, std::size_t row_count, std::size_t columns,
                      const double* weights, double* sums) {
  HWY_DYNAMIC_DISPATCH(sum_rows_once)(rows, row_count, columns, weights, sums);
}

void detail::sum_rows_by_three(const double* rows, std::size_t row_count, std::size_t columns,
                               const double* weights, double* sums, std::size_t stride) {
  HWY_DYNAMIC_DISPATCH(sum_rows_thrice)(rows, row_count, columns, weights, sums, stride);
}

}  // namespace lamina
#endif

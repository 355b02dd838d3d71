// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/heterogeneous/blurs/internal/gaussian_blur_kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE \
  "lamina/solve/scattering/heterogeneous/blurs/internal/gaussian_blur_kernels.cpp"
#include <hwy/foreach_target.h>  // compiles this file once per instruction set
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace lamina::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Calls `body` with vectors of numbers over [0, size), and with single ones for what is left.
/// (The last lanes one by one: rows end where the next one starts.)
template <class T, class Body>
HWY_INLINE void for_each_place(std::size_t size, const Body& body) {
  const hn::ScalableTag<T> wide;
  const hn::CappedTag<T, 1> single;
  std::size_t x = 0;
  for (; x + hn::Lanes(wide) <= size; x += hn::Lanes(wide)) body(wide, x);
  for (; x < size; ++x) body(single, x);
}

template <class T>
HWY_ATTR void combine_rows(std::span<const T* const> rows, std::span<const float> taps, T* sum,
                           std::size_t size) {
  const std::size_t r = taps.size() - 1;
  for_each_place<T>(size, [&](auto d, std::size_t x) HWY_ATTR {
    auto total = hn::Mul(hn::Set(d, static_cast<T>(taps[0])), hn::LoadU(d, rows[r] + x));
    for (std::size_t n = 1; n <= r; ++n)
      total =
          hn::MulAdd(hn::Set(d, static_cast<T>(taps[n])),
                     hn::Add(hn::LoadU(d, rows[r - n] + x), hn::LoadU(d, rows[r + n] + x)), total);
    hn::StoreU(total, d, sum + x);
  });
}

template <class T>
HWY_ATTR void convolve_row(const T* row, std::span<const float> taps, T* result, std::size_t size) {
  for_each_place<T>(size, [&](auto d, std::size_t x) HWY_ATTR {
    auto total = hn::Mul(hn::Set(d, static_cast<T>(taps[0])), hn::LoadU(d, row + x));
    for (std::size_t n = 1; n < taps.size(); ++n)
      total = hn::MulAdd(hn::Set(d, static_cast<T>(taps[n])),
                         hn::Add(hn::LoadU(d, row + x - n), hn::LoadU(d, row + x + n)), total);
    hn::StoreU(total, d, result + x);
  });
}

template <class T>
HWY_ATTR void add_times_polynomial(const T* row, const T* coordinate,
                                   std::span<const T> coefficients, T* sum, std::size_t size) {
  for_each_place<T>(size, [&](auto d, std::size_t x) HWY_ATTR {
    const auto at = hn::LoadU(d, coordinate + x);
    auto value = hn::Set(d, coefficients.back());
    for (std::size_t p = coefficients.size() - 1; p-- > 0;)
      value = hn::MulAdd(value, at, hn::Set(d, coefficients[p]));
    hn::StoreU(hn::MulAdd(value, hn::LoadU(d, row + x), hn::LoadU(d, sum + x)), d, sum + x);
  });
}

template <class T>
HWY_ATTR void add_times_polynomial_and_slope(const T* row, const T* coordinate,
                                             std::span<const T> coefficients, T* sum, T* slope,
                                             std::size_t size) {
  for_each_place<T>(size, [&](auto d, std::size_t x) HWY_ATTR {
    const auto at = hn::LoadU(d, coordinate + x), light = hn::LoadU(d, row + x);
    auto value = hn::Set(d, coefficients.back()), rise = hn::Zero(d);
    for (std::size_t p = coefficients.size() - 1; p-- > 0;) {
      rise = hn::MulAdd(rise, at, value);
      value = hn::MulAdd(value, at, hn::Set(d, coefficients[p]));
    }
    hn::StoreU(hn::MulAdd(value, light, hn::LoadU(d, sum + x)), d, sum + x);
    hn::StoreU(hn::MulAdd(rise, light, hn::LoadU(d, slope + x)), d, slope + x);
  });
}

template <class T>
HWY_ATTR void add_times_modes(const T* row, std::span<const T* const> modes,
                              std::span<const T> coefficients, T* sum, std::size_t size) {
  for_each_place<T>(size, [&](auto d, std::size_t x) HWY_ATTR {
    auto value = hn::Mul(hn::Set(d, coefficients[0]), hn::LoadU(d, modes[0] + x));
    for (std::size_t p = 1; p < coefficients.size(); ++p)
      value = hn::MulAdd(hn::Set(d, coefficients[p]), hn::LoadU(d, modes[p] + x), value);
    hn::StoreU(hn::MulAdd(value, hn::LoadU(d, row + x), hn::LoadU(d, sum + x)), d, sum + x);
  });
}

template <class T>
HWY_ATTR void halve_row(const T* row, T* result, std::size_t size) {
  for_each_place<T>(size, [&](auto d, std::size_t x) HWY_ATTR {
    const auto eighth = hn::Set(d, T(0.125)), three = hn::Set(d, T(3));
    hn::Vec<decltype(d)> unused, before, near, far, after;
    hn::LoadInterleaved2(d, row + 2 * x - 2, unused, before);
    hn::LoadInterleaved2(d, row + 2 * x, near, far);
    hn::LoadInterleaved2(d, row + 2 * x + 2, after, unused);
    const auto total = hn::MulAdd(three, hn::Add(near, far), hn::Add(before, after));
    hn::StoreU(hn::Mul(eighth, total), d, result + x);
  });
}

template <class T>
HWY_ATTR void double_row(const T* row, T* result, std::size_t size) {
  for_each_place<T>(size / 2, [&](auto d, std::size_t x) HWY_ATTR {
    const auto quarter = hn::Set(d, T(0.25));
    const auto near = hn::Mul(hn::Set(d, T(0.75)), hn::LoadU(d, row + x));
    const auto even = hn::MulAdd(quarter, hn::LoadU(d, row + x - 1), near);
    const auto odd = hn::MulAdd(quarter, hn::LoadU(d, row + x + 1), near);
    hn::StoreInterleaved2(even, odd, d, result + 2 * x);
  });
}

template <class T>
HWY_ATTR void add_row(const T* row, T weight, T* sum, std::size_t size) {
  for_each_place<T>(size, [&](auto d, std::size_t x) HWY_ATTR {
    hn::StoreU(hn::MulAdd(hn::Set(d, weight), hn::LoadU(d, row + x), hn::LoadU(d, sum + x)), d,
               sum + x);
  });
}

template <class T>
HWY_ATTR void multiply_row(const T* row, const T* factors, T* result, std::size_t size) {
  for_each_place<T>(size, [&](auto d, std::size_t x) HWY_ATTR {
    hn::StoreU(hn::Mul(hn::LoadU(d, row + x), hn::LoadU(d, factors + x)), d, result + x);
  });
}

template <class T>
HWY_ATTR void add_polynomial(std::span<const T* const> rows, const T* coordinate, T* sum,
                             std::size_t size) {
  for_each_place<T>(size, [&](auto d, std::size_t x) HWY_ATTR {
    const auto at = hn::LoadU(d, coordinate + x);
    auto value = hn::LoadU(d, rows.back() + x);
    for (std::size_t p = rows.size() - 1; p-- > 0;)
      value = hn::MulAdd(value, at, hn::LoadU(d, rows[p] + x));
    hn::StoreU(hn::Add(hn::LoadU(d, sum + x), value), d, sum + x);
  });
}

template <class T>
HWY_ATTR void add_polynomial_and_slope(std::span<const T* const> rows, const T* coordinate, T* sum,
                                       T* slope, std::size_t size) {
  for_each_place<T>(size, [&](auto d, std::size_t x) HWY_ATTR {
    const auto at = hn::LoadU(d, coordinate + x);
    auto value = hn::LoadU(d, rows.back() + x), rise = hn::Zero(d);
    for (std::size_t p = rows.size() - 1; p-- > 0;) {
      rise = hn::MulAdd(rise, at, value);
      value = hn::MulAdd(value, at, hn::LoadU(d, rows[p] + x));
    }
    hn::StoreU(hn::Add(hn::LoadU(d, sum + x), value), d, sum + x);
    hn::StoreU(hn::Add(hn::LoadU(d, slope + x), rise), d, slope + x);
  });
}

template <class T>
HWY_ATTR void add_products(std::span<const T* const> rows, std::span<const T* const> modes, T* sum,
                           std::size_t size) {
  for_each_place<T>(size, [&](auto d, std::size_t x) HWY_ATTR {
    auto value = hn::LoadU(d, sum + x);
    for (std::size_t p = 0; p < rows.size(); ++p)
      value = hn::MulAdd(hn::LoadU(d, rows[p] + x), hn::LoadU(d, modes[p] + x), value);
    hn::StoreU(value, d, sum + x);
  });
}

template <class T>
const detail::BlurKernels<T>& table() {
  static constexpr detail::BlurKernels<T> kernels = {
      .combine_rows = combine_rows<T>,
      .convolve_row = convolve_row<T>,
      .add_times_polynomial = add_times_polynomial<T>,
      .add_times_polynomial_and_slope = add_times_polynomial_and_slope<T>,
      .add_times_modes = add_times_modes<T>,
      .halve_row = halve_row<T>,
      .double_row = double_row<T>,
      .add_row = add_row<T>,
      .multiply_row = multiply_row<T>,
      .add_polynomial = add_polynomial<T>,
      .add_polynomial_and_slope = add_polynomial_and_slope<T>,
      .add_products = add_products<T>};
  return kernels;
}
const detail::BlurKernels<float>& float_table() { return table<float>(); }
const detail::BlurKernels<double>& double_table() { return table<double>(); }

}  // namespace lamina::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace lamina {

HWY_EXPORT(float_table);
HWY_EXPORT(double_table);

template <>
const detail::BlurKernels<float>& detail::blur_kernels() {
  return HWY_DYNAMIC_DISPATCH(float_table)();
}
template <>
const detail::BlurKernels<double>& detail::blur_kernels() {
  return HWY_DYNAMIC_DISPATCH(double_table)();
}

}  // namespace lamina
#endif

// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scattering/heterogeneous/blurs/internal/gaussian_blur_kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE \
  "lamina/scattering/heterogeneous/blurs/internal/gaussian_blur_kernels.cpp"
#include <hwy/foreach_target.h>  // compiles this file once per instruction set
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace lamina::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Calls `body` with vectors of floats over [0, size), and with single floats for what is left.
/// (The last lanes one by one: rows end where the next one starts.)
template <class Body>
HWY_INLINE void for_each_place(std::size_t size, const Body& body) {
  const hn::ScalableTag<float> wide;
  const hn::CappedTag<float, 1> single;
  std::size_t x = 0;
  for (; x + hn::Lanes(wide) <= size; x += hn::Lanes(wide)) body(wide, x);
  for (; x < size; ++x) body(single, x);
}

HWY_ATTR void combine_rows(std::span<const float* const> rows, std::span<const float> taps,
                           float* sum, std::size_t size) {
  const std::size_t r = taps.size() - 1;
  for_each_place(size, [&](auto d, std::size_t x) HWY_ATTR {
    auto total = hn::Mul(hn::Set(d, taps[0]), hn::LoadU(d, rows[r] + x));
    for (std::size_t n = 1; n <= r; ++n)
      total =
          hn::MulAdd(hn::Set(d, taps[n]),
                     hn::Add(hn::LoadU(d, rows[r - n] + x), hn::LoadU(d, rows[r + n] + x)), total);
    hn::StoreU(total, d, sum + x);
  });
}

HWY_ATTR void convolve_row(const float* row, std::span<const float> taps, float* result,
                           std::size_t size) {
  for_each_place(size, [&](auto d, std::size_t x) HWY_ATTR {
    auto total = hn::Mul(hn::Set(d, taps[0]), hn::LoadU(d, row + x));
    for (std::size_t n = 1; n < taps.size(); ++n)
      total = hn::MulAdd(hn::Set(d, taps[n]),
                         hn::Add(hn::LoadU(d, row + x - n), hn::LoadU(d, row + x + n)), total);
    hn::StoreU(total, d, result + x);
  });
}

HWY_ATTR void add_times_polynomial(const float* row, const float* coordinate,
                                   std::span<const float> coefficients, float* sum,
                                   std::size_t size) {
  for_each_place(size, [&](auto d, std::size_t x) HWY_ATTR {
    const auto at = hn::LoadU(d, coordinate + x);
    auto value = hn::Set(d, coefficients.back());
    for (std::size_t p = coefficients.size() - 1; p-- > 0;)
      value = hn::MulAdd(value, at, hn::Set(d, coefficients[p]));
    hn::StoreU(hn::MulAdd(value, hn::LoadU(d, row + x), hn::LoadU(d, sum + x)), d, sum + x);
  });
}

HWY_ATTR void add_times_modes(const float* row, std::span<const float* const> modes,
                              std::span<const float> coefficients, float* sum, std::size_t size) {
  for_each_place(size, [&](auto d, std::size_t x) HWY_ATTR {
    auto value = hn::Mul(hn::Set(d, coefficients[0]), hn::LoadU(d, modes[0] + x));
    for (std::size_t p = 1; p < coefficients.size(); ++p)
      value = hn::MulAdd(hn::Set(d, coefficients[p]), hn::LoadU(d, modes[p] + x), value);
    hn::StoreU(hn::MulAdd(value, hn::LoadU(d, row + x), hn::LoadU(d, sum + x)), d, sum + x);
  });
}

HWY_ATTR void halve_row(const float* row, float* result, std::size_t size) {
  for_each_place(size, [&](auto d, std::size_t x) HWY_ATTR {
    const auto eighth = hn::Set(d, 0.125f), three = hn::Set(d, 3.0f);
    hn::Vec<decltype(d)> unused, before, near, far, after;
    hn::LoadInterleaved2(d, row + 2 * x - 2, unused, before);
    hn::LoadInterleaved2(d, row + 2 * x, near, far);
    hn::LoadInterleaved2(d, row + 2 * x + 2, after, unused);
    const auto total = hn::MulAdd(three, hn::Add(near, far), hn::Add(before, after));
    hn::StoreU(hn::Mul(eighth, total), d, result + x);
  });
}

HWY_ATTR void double_row(const float* row, float* result, std::size_t size) {
  for_each_place(size / 2, [&](auto d, std::size_t x) HWY_ATTR {
    const auto quarter = hn::Set(d, 0.25f);
    const auto near = hn::Mul(hn::Set(d, 0.75f), hn::LoadU(d, row + x));
    const auto even = hn::MulAdd(quarter, hn::LoadU(d, row + x - 1), near);
    const auto odd = hn::MulAdd(quarter, hn::LoadU(d, row + x + 1), near);
    hn::StoreInterleaved2(even, odd, d, result + 2 * x);
  });
}

HWY_ATTR void add_row(const float* row, float weight, float* sum, std::size_t size) {
  for_each_place(size, [&](auto d, std::size_t x) HWY_ATTR {
    hn::StoreU(hn::MulAdd(hn::Set(d, weight), hn::LoadU(d, row + x), hn::LoadU(d, sum + x)), d,
               sum + x);
  });
}

HWY_ATTR void add_polynomial(std::span<const float* const> rows, const float* coordinate,
                             float* sum, std::size_t size) {
  for_each_place(size, [&](auto d, std::size_t x) HWY_ATTR {
    const auto at = hn::LoadU(d, coordinate + x);
    auto value = hn::LoadU(d, rows.back() + x);
    for (std::size_t p = rows.size() - 1; p-- > 0;)
      value = hn::MulAdd(value, at, hn::LoadU(d, rows[p] + x));
    hn::StoreU(hn::Add(hn::LoadU(d, sum + x), value), d, sum + x);
  });
}

HWY_ATTR void add_products(std::span<const float* const> rows, std::span<const float* const> modes,
                           float* sum, std::size_t size) {
  for_each_place(size, [&](auto d, std::size_t x) HWY_ATTR {
    auto value = hn::LoadU(d, sum + x);
    for (std::size_t p = 0; p < rows.size(); ++p)
      value = hn::MulAdd(hn::LoadU(d, rows[p] + x), hn::LoadU(d, modes[p] + x), value);
    hn::StoreU(value, d, sum + x);
  });
}

}  // namespace lamina::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace lamina {

HWY_EXPORT(combine_rows);
HWY_EXPORT(convolve_row);
HWY_EXPORT(add_times_polynomial);
HWY_EXPORT(add_times_modes);
HWY_EXPORT(halve_row);
HWY_EXPORT(double_row);
HWY_EXPORT(add_row);
HWY_EXPORT(add_polynomial);
HWY_EXPORT(add_products);

void detail::combine_rows(std::span<const float* const> rows, std::span<const float> taps,
                          float* sum, std::size_t size) {
  HWY_DYNAMIC_DISPATCH(combine_rows)(rows, taps, sum, size);
}
void detail::convolve_row(const float* row, std::span<const float> taps, float* result,
                          std::size_t size) {
  HWY_DYNAMIC_DISPATCH(convolve_row)(row, taps, result, size);
}
void detail::add_times_polynomial(const float* row, const float* coordinate,
                                  std::span<const float> coefficients, float* sum,
                                  std::size_t size) {
  HWY_DYNAMIC_DISPATCH(add_times_polynomial)(row, coordinate, coefficients, sum, size);
}
void detail::add_times_modes(const float* row, std::span<const float* const> modes,
                             std::span<const float> coefficients, float* sum, std::size_t size) {
  HWY_DYNAMIC_DISPATCH(add_times_modes)(row, modes, coefficients, sum, size);
}
void detail::halve_row(const float* row, float* result, std::size_t size) {
  HWY_DYNAMIC_DISPATCH(halve_row)(row, result, size);
}
void detail::double_row(const float* row, float* result, std::size_t size) {
  HWY_DYNAMIC_DISPATCH(double_row)(row, result, size);
}
void detail::add_row(const float* row, float weight, float* sum, std::size_t size) {
  HWY_DYNAMIC_DISPATCH(add_row)(row, weight, sum, size);
}
void detail::add_polynomial(std::span<const float* const> rows, const float* coordinate, float* sum,
                            std::size_t size) {
  HWY_DYNAMIC_DISPATCH(add_polynomial)(rows, coordinate, sum, size);
}
void detail::add_products(std::span<const float* const> rows, std::span<const float* const> modes,
                          float* sum, std::size_t size) {
  HWY_DYNAMIC_DISPATCH(add_products)(rows, modes, sum, size);
}

}  // namespace lamina
#endif

// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/profile/bessel.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace lamina::detail {
namespace {

/// Bessel functions at equal steps of their argument.
class BesselTable {
 public:
  // Enough for straight rays: test Bessel.TableAgreesWithTheStandardLibrary.
  static constexpr std::size_t orders = 48;
  static constexpr double last = 112.0;

  BesselTable() : values_(static_cast<std::size_t>(last * steps_per_unit + 2.0) * row_length) {
    for (std::size_t i = 0; i * row_length < values_.size(); ++i) {
      double* const at = &values_[i * row_length];
      bessel_functions(static_cast<double>(i) / steps_per_unit, {at + 1, row_length - 1});
      at[0] = -at[2];
    }
  }

  void evaluate(double x, std::span<double> out) const {
    const double place = x * steps_per_unit, floor = std::floor(place), t = place - floor;
    const double* const low = &values_[static_cast<std::size_t>(floor) * row_length + 1];
    const double* const high = low + row_length;
    const double s = 1.0 - t, half_step = 0.5 / steps_per_unit;
    const double of_low = s * s * (1.0 + 2.0 * t), of_high = t * t * (1.0 + 2.0 * s);
    const double low_slope = s * s * t * half_step, high_slope = -t * t * s * half_step;
    for (std::ptrdiff_t m = 0; m < static_cast<std::ptrdiff_t>(out.size()); ++m)
      out[static_cast<std::size_t>(m)] = of_low * low[m] + of_high * high[m] +
                                         low_slope * (low[m - 1] - low[m + 1]) +
                                         high_slope * (high[m - 1] - high[m + 1]);
  }

 private:
  // Cubics to 1e-7: test Bessel.TableAgreesWithTheStandardLibrary.
  static constexpr double steps_per_unit = 16.0;
  static constexpr std::size_t row_length = orders + 2;  ///< from order -1 on

  std::vector<double> values_;  ///< [argument][order]
};

}  // namespace

void bessel_functions(double x, std::span<double> out) {
  const int n = static_cast<int>(out.size()) - 1;
  std::fill(out.begin(), out.end(), 0.0);
  out[0] = 1.0;
  if (x < 1e-9) return;
  const double largest = std::max(x, static_cast<double>(n));
  const int start = 2 * static_cast<int>(0.5 * (largest + 12.0 * std::cbrt(largest)) + 8.0);
  const double two_over_x = 2.0 / x;
  double above = 0.0, here = 1e-280, sum = 0.0;
  for (int m = start; m > 0; --m) {  // here is J_m
    if (m <= n) out[static_cast<std::size_t>(m)] = here;
    if (m % 2 == 0) sum += 2.0 * here;
    const double below = static_cast<double>(m) * two_over_x * here - above;
    above = here;
    here = below;
    if (std::abs(here) < 1e200) continue;
    here *= 1e-250;
    above *= 1e-250;
    sum *= 1e-250;
    for (int q = m; q <= n; ++q) out[static_cast<std::size_t>(q)] *= 1e-250;
  }
  out[0] = here;
  sum += here;
  for (int m = 0; m <= n; ++m) out[static_cast<std::size_t>(m)] /= sum;
}

void tabulated_bessel_functions(double x, std::span<double> out) {
  static const BesselTable table;
  if (out.size() > BesselTable::orders || !(x < BesselTable::last)) return bessel_functions(x, out);
  table.evaluate(x, out);
}

}  // namespace lamina::detail

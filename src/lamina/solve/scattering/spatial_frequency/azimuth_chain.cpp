// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/spatial_frequency/azimuth_chain.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>

namespace lamina::detail {
namespace {

/// Last coupling but one, last coupling, damping.
struct ChainEnd {
  double coupling_before, coupling, damping;
};

constexpr std::array<ChainEnd, 11> chain_ends = {{
    {0.0, 1.0, 1.0},  // M = 1
    {0.7071, 0.6162, 0.5965},
    {0.5163, 0.6396, 0.6528},
    {0.5185, 0.6807, 0.7867},
    {0.5194, 0.6953, 0.8325},
    {0.5200, 0.7063, 0.8671},
    {0.5204, 0.7146, 0.8934},
    {0.5207, 0.7224, 0.9182},
    {0.5209, 0.7287, 0.9383},
    {0.5211, 0.7337, 0.9542},
    {0.5213, 0.7384, 0.9692},
}};

using Complex = std::complex<double>;

/// The characteristic polynomial of the chain at x over its derivative, by the recurrence of
/// tridiagonal matrices.
Complex newton_step(const AzimuthChain& chain, Complex x) {
  const std::size_t last = chain.coupling.size();
  Complex before = 1.0, p = x, slope_before = 0.0, slope = 1.0;
  for (std::size_t m = 1; m <= last; ++m) {
    const Complex along = x + (m == last ? chain.damping : 0.0);
    const double c2 = chain.coupling[m - 1] * chain.coupling[m - 1];
    const Complex next = along * p + c2 * before;
    const Complex next_slope = p + along * slope + c2 * slope_before;
    before = std::exchange(p, next);
    slope_before = std::exchange(slope, next_slope);
  }
  return p / slope;
}

/// All rates of decay, by [Aberth1973]'s simultaneous iteration: they are simple.
std::vector<Complex> rates_of_waves(const AzimuthChain& chain) {
  const std::size_t n = chain.coupling.size() + 1;
  std::vector<Complex> rates;
  for (std::size_t q = 0; q < n; ++q)  // near those of a chain cut off
    rates.emplace_back(-0.1, std::cos((static_cast<double>(q) + 0.45) * std::numbers::pi /
                                      static_cast<double>(n)));
  constexpr int most_rounds = 200;  // some ten do
  double moved = 1.0;
  for (int round = 0; round < most_rounds && moved > 1e-15; ++round) {
    moved = 0.0;
    for (std::size_t q = 0; q < n; ++q) {
      Complex others = 0.0;
      for (std::size_t j = 0; j < n; ++j)
        if (j != q) others += 1.0 / (rates[q] - rates[j]);
      const Complex step = newton_step(chain, rates[q]);
      const Complex by = step / (1.0 - step * others);
      rates[q] -= by;
      moved = std::max(moved, std::abs(by));
    }
  }
  return rates;
}

}  // namespace

AzimuthChain make_azimuth_chain(int modes, AzimuthEnd end_kind) {
  assert(modes >= 1 && (end_kind == AzimuthEnd::absorbing || modes % 2 == 1));
  AzimuthChain chain;
  const auto count = static_cast<std::size_t>(modes);
  chain.coupling.assign(count, 0.5);
  chain.coupling[0] = 0.5 * std::numbers::sqrt2;
  if (end_kind == AzimuthEnd::cut_off) return chain;
  const ChainEnd& end = chain_ends[std::min(count, chain_ends.size()) - 1];
  if (modes > 1) chain.coupling[count - 2] = end.coupling_before;
  chain.coupling[count - 1] = end.coupling;
  chain.damping = end.damping;
  return chain;
}

AzimuthWaves azimuth_waves(const AzimuthChain& chain) {
  const std::size_t n = chain.coupling.size() + 1;
  AzimuthWaves result;
  result.weight.resize(n);
  for (Complex rate : rates_of_waves(chain)) {
    constexpr double rounding = 1e-9;       // rates are real or one of two, far apart
    if (rate.imag() < -rounding) continue;  // the conjugate of another
    const bool is_real = rate.imag() <= rounding;
    if (is_real) rate = rate.real();
    // The wave's shape, row by row; that of light which goes back through the chain differs by the
    // signs of its odd modes, so that both give the norm.
    std::vector<Complex> shape = {1.0, -rate / chain.coupling[0]};
    for (std::size_t m = 1; m + 1 < n; ++m)
      shape.push_back((chain.coupling[m - 1] * shape[m - 1] - rate * shape[m]) / chain.coupling[m]);
    Complex norm = 0.0;
    for (std::size_t m = 0; m < n; ++m) norm += (m % 2 == 0 ? 1.0 : -1.0) * shape[m] * shape[m];
    result.rate.push_back(rate);
    for (std::size_t m = 0; m < n; ++m)
      result.weight[m].push_back((is_real ? 1.0 : 2.0) * shape[m] / norm);
  }
  return result;
}

}  // namespace lamina::detail

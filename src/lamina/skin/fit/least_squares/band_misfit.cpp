// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/fit/least_squares/band_misfit.h"

#include <algorithm>
#include <cmath>

namespace lamina {

void add_misfit(std::vector<BandMisfit>& sum, std::span<const BandMisfit> more) {
  sum.resize(std::max(sum.size(), more.size()));
  for (std::size_t b = 0; b < more.size(); ++b) {
    sum[b].squares += more[b].squares;
    sum[b].left += more[b].left;
    sum[b].count += more[b].count;
  }
}

std::vector<double> chi_squared_of(std::span<const BandMisfit> bands) {
  constexpr double of_others = 0.1;
  const auto quotient = [](const BandMisfit& band, double others) {
    const double weight = of_others * band.count;
    return band.count > 0.0 ? (band.squares + weight * others) / (std::max(band.left, 0.0) + weight)
                            : others;
  };
  BandMisfit all;
  for (const BandMisfit& band : bands) {
    all.squares += band.squares;
    all.left += band.left;
    all.count += band.count;
  }
  const double together = quotient(all, 1.0);
  std::vector<double> result;
  for (const BandMisfit& band : bands) result.push_back(quotient(band, together));
  return result;
}

std::vector<double> error_growth_of(std::span<const BandMisfit> bands) {
  std::vector<double> growth = chi_squared_of(bands);
  for (double& each : growth) each = std::sqrt(std::max(1.0, each));
  return growth;
}

double largest_ratio(std::span<const double> factors, std::span<const double> others) {
  double largest = factors.empty() ? 1.0 : 0.0;
  for (std::size_t b = 0; b < factors.size(); ++b)
    largest = std::max(largest, factors[b] / (b < others.size() ? others[b] : 1.0));
  return largest;
}

}  // namespace lamina

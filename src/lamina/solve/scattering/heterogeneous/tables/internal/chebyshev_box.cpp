// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/heterogeneous/tables/internal/chebyshev_box.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace lamina::detail {
namespace {

std::vector<double> chebyshev_points(std::size_t n) {
  std::vector<double> x;
  for (std::size_t i = 0; i < n; ++i)
    x.push_back(
        std::cos(std::numbers::pi * (static_cast<double>(i) + 0.5) / static_cast<double>(n)));
  return x;
}

/// Shares of values at Chebyshev points in their polynomial, by the barycentric formula
/// [Berrut2004].
std::vector<double> barycentric_shares(const std::vector<double>& points, double x) {
  std::vector<double> shares(points.size(), 0.0);
  double sum = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (x == points[i]) {
      shares.assign(points.size(), 0.0);
      shares[i] = 1.0;
      return shares;
    }
    const double angle =
        std::numbers::pi * (static_cast<double>(i) + 0.5) / static_cast<double>(points.size());
    shares[i] = (i % 2 == 0 ? 1.0 : -1.0) * std::sin(angle) / (x - points[i]);
    sum += shares[i];
  }
  for (double& share : shares) share /= sum;
  return shares;
}

}  // namespace

ChebyshevBox::ChebyshevBox(StateLattice lattice, double per_unit, std::size_t most)
    : lattice_(std::move(lattice)) {
  constexpr std::size_t most_together = 150;
  for (std::size_t all = most_together + 1; all > most_together && most > 1; --most) {
    points_.clear();
    all = 1;
    for (const StateAxis& axis : lattice_.axes) {
      const auto wanted =
          static_cast<std::size_t>(std::ceil(3.0 + per_unit * (axis.high - axis.low)));
      points_.push_back(chebyshev_points(std::min(wanted, most)));
      all *= points_.back().size();
    }
  }
}

std::size_t ChebyshevBox::size() const {
  std::size_t all = 1;
  for (const auto& points : points_) all *= points.size();
  return all;
}

LayerState ChebyshevBox::state(std::size_t point) const {
  LatticePlace fractions{};
  for (std::size_t a = 0; a < points_.size(); ++a) {
    fractions[a] = 0.5 * (1.0 + points_[a][point % points_[a].size()]);
    point /= points_[a].size();
  }
  return state_at(lattice_, fractions);
}

std::vector<double> ChebyshevBox::shares(const LayerState& state) const {
  const LatticePlace place = place_in(lattice_, state);
  std::vector<double> all = {1.0};
  for (std::size_t a = 0; a < points_.size(); ++a) {
    const double x = 2.0 * place[a] / static_cast<double>(lattice_.axes[a].nodes - 1) - 1.0;
    const std::vector<double> along = barycentric_shares(points_[a], x);
    std::vector<double> product;
    for (const double share : along)
      for (const double before : all) product.push_back(share * before);
    all = std::move(product);
  }
  return all;
}

}  // namespace lamina::detail

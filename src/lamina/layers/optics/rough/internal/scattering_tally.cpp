// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/layers/optics/rough/internal/scattering_tally.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lamina::detail {
namespace {

using std::numbers::pi;

std::size_t size_of(ExitCells cells) {
  return static_cast<std::size_t>(cells.thetas) * static_cast<std::size_t>(cells.phis);
}

/// What `total` says of all parts, per ray, with the standard error from the scatter between parts
/// and from one more ray of weight `largest`: where none was seen, one could have come.
template <class Total>
Estimate mean_of(std::span<const ScatteringTally> parts, const Total& total, double largest = 1.0) {
  double sum = 0.0, rays = 0.0, scatter = 0.0;
  for (const ScatteringTally& part : parts) {
    sum += total(part);
    rays += static_cast<double>(part.rays());
  }
  const double mean = sum / rays, n = static_cast<double>(parts.size());
  for (const ScatteringTally& part : parts) {
    const double off = total(part) - mean * static_cast<double>(part.rays());
    scatter += off * off;
  }
  if (n > 1.0) scatter *= n / (n - 1.0);
  return {mean, std::sqrt(scatter + largest * largest) / rays};
}

}  // namespace

ScatteringTally::ScatteringTally(ExitCells cells) : cells_(cells) {
  for (Side& side : sides_)
    side.all = side.all2 = side.single = std::vector<double>(size_of(cells), 0.0);
}

void ScatteringTally::leave(const Vec3& wo, int order, double weight) {
  if (order == 0) {
    given_up_ += weight;
    return;
  }
  const double theta = std::atan2(std::hypot(wo.x, wo.y), std::abs(wo.z));
  const double phi = std::abs(std::atan2(wo.y, -wo.x));  // wi.x >= 0: forward is away from it
  const auto i = std::min(static_cast<int>(theta / (0.5 * pi) * cells_.thetas), cells_.thetas - 1);
  const auto j = std::min(static_cast<int>(phi / pi * cells_.phis), cells_.phis - 1);
  const auto cell = static_cast<std::size_t>(i * cells_.phis + j);
  Side& side = sides_[wo.z > 0.0 ? 0 : 1];
  side.all[cell] += weight;
  side.all2[cell] += weight * weight;
  side.total += weight;
  if (order > 1) return;
  side.single[cell] += weight;
  side.single_total += weight;
}

double projected_solid_angle(ExitCells cells, int theta) {
  const double step = 0.5 * pi / cells.thetas;
  const double from = std::sin(theta * step), to = std::sin((theta + 1) * step);
  return pi / cells.phis * (to * to - from * from);
}

RoughSurfaceScattering scattering_of(std::span<const ScatteringTally> parts) {
  const ExitCells cells = parts.front().cells_;
  double rays = 0.0;
  for (const ScatteringTally& part : parts) rays += static_cast<double>(part.rays());

  RoughSurfaceScattering result{.cells = cells};
  const auto sums = [&](std::size_t side, std::vector<double> ScatteringTally::Side::*of) {
    std::vector<double> values(size_of(cells), 0.0);
    for (const ScatteringTally& part : parts)
      for (std::size_t k = 0; k < values.size(); ++k) values[k] += (part.sides_[side].*of)[k];
    return values;
  };
  const auto solid_angle = [&](std::size_t k) {
    return projected_solid_angle(cells, static_cast<int>(k) / cells.phis);
  };
  const auto over_cells = [&](std::size_t side, std::vector<double> ScatteringTally::Side::*of) {
    std::vector<double> values = sums(side, of);
    for (std::size_t k = 0; k < values.size(); ++k) values[k] /= rays * solid_angle(k);
    return values;
  };
  const auto errors = [&](std::size_t side) {
    std::vector<double> values = sums(side, &ScatteringTally::Side::all);
    const std::vector<double> squares = sums(side, &ScatteringTally::Side::all2);
    for (std::size_t k = 0; k < values.size(); ++k)
      values[k] = sample_mean(rays, values[k], squares[k]).standard_error / solid_angle(k);
    return values;
  };
  result.brdf = over_cells(0, &ScatteringTally::Side::all);
  result.btdf = over_cells(1, &ScatteringTally::Side::all);
  result.brdf_error = errors(0);
  result.btdf_error = errors(1);
  result.single_brdf = over_cells(0, &ScatteringTally::Side::single);
  result.single_btdf = over_cells(1, &ScatteringTally::Side::single);

  using T = ScatteringTally;
  result.reflectance = mean_of(parts, [](const T& t) { return t.sides_[0].total; });
  result.transmittance = mean_of(parts, [](const T& t) { return t.sides_[1].total; });
  result.single_reflectance = mean_of(parts, [](const T& t) { return t.sides_[0].single_total; });
  result.single_transmittance = mean_of(parts, [](const T& t) { return t.sides_[1].single_total; });
  result.start_weight = mean_of(
      parts, [](const T& t) { return t.started_; }, 0.0);
  result.given_up = mean_of(parts, [](const T& t) { return t.given_up_; }).value;
  return result;
}

}  // namespace lamina::detail

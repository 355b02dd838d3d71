// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/optics/scattering_tally.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lamina::detail {
namespace {

constexpr double pi = std::numbers::pi;

std::size_t size_of(ExitCells cells) {
  return static_cast<std::size_t>(cells.thetas) * static_cast<std::size_t>(cells.phis);
}

/// What `total` says of all parts, per ray, with the standard error from the scatter between parts.
template <class Total>
Estimate mean_of(std::span<const ScatteringTally> parts, const Total& total) {
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
  return {mean, n > 1.0 ? std::sqrt(scatter * n / (n - 1.0)) / rays : 0.0};
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
  const double phi = std::abs(std::atan2(wo.y, wo.x));  // wi lies in the half-plane of azimuth 0
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
  const auto over_cells = [&](int s, std::vector<double> ScatteringTally::Side::* of, bool error) {
    std::vector<double> values(size_of(cells), 0.0);
    for (const ScatteringTally& part : parts)
      for (std::size_t k = 0; k < values.size(); ++k)
        values[k] += (part.sides_[static_cast<std::size_t>(s)].*of)[k];
    for (std::size_t k = 0; k < values.size(); ++k)
      values[k] = (error ? std::sqrt(values[k]) : values[k]) /
                  (rays * projected_solid_angle(cells, static_cast<int>(k) / cells.phis));
    return values;
  };
  result.brdf = over_cells(0, &ScatteringTally::Side::all, false);
  result.btdf = over_cells(1, &ScatteringTally::Side::all, false);
  result.brdf_error = over_cells(0, &ScatteringTally::Side::all2, true);
  result.btdf_error = over_cells(1, &ScatteringTally::Side::all2, true);
  result.single_brdf = over_cells(0, &ScatteringTally::Side::single, false);
  result.single_btdf = over_cells(1, &ScatteringTally::Side::single, false);

  using T = ScatteringTally;
  result.reflectance = mean_of(parts, [](const T& t) { return t.sides_[0].total; });
  result.transmittance = mean_of(parts, [](const T& t) { return t.sides_[1].total; });
  result.single_reflectance = mean_of(parts, [](const T& t) { return t.sides_[0].single_total; });
  result.single_transmittance = mean_of(parts, [](const T& t) { return t.sides_[1].single_total; });
  result.start_weight = mean_of(parts, [](const T& t) { return t.started_; });
  result.given_up = mean_of(parts, [](const T& t) { return t.given_up_; }).value;
  return result;
}

}  // namespace lamina::detail

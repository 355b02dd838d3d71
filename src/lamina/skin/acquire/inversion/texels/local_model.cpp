// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/acquire/inversion/texels/local_model.h"

#include <algorithm>
#include <cmath>

#include "lamina/skin/fit/least_squares/small_fit.h"

namespace lamina::detail {
namespace {

using TexelObjective = SmallSquares<most_free_numbers>;

TexelObjective objective_at(LocalModel& model, const TexelData& data, const InversionTables& tables,
                            std::span<const double> coordinates, double robust_limit) {
  const std::size_t n = coordinates.size();
  TexelObjective result;
  model.predict(coordinates);
  for (std::size_t i = 0; i < data.measured.size(); ++i) {
    if (data.weight[i] == 0.0) continue;
    const double scale = data.level[i] * data.weight[i];
    const double residual = scale * model.reflectance[i] - data.measured[i] * data.weight[i];
    const double size = std::abs(residual);
    const bool is_far = robust_limit > 0.0 && size > robust_limit;
    const double share = is_far ? robust_limit / size : 1.0;  // of the square that counts (Huber)
    result.value += is_far ? robust_limit * (size - 0.5 * robust_limit) : 0.5 * residual * residual;
    for (std::size_t a = 0; a < n; ++a) {
      const double by_a = scale * model.by_number[i][a];
      result.gradient[a] += share * residual * by_a;
      for (std::size_t b = 0; b <= a; ++b)
        result.curvature[a][b] += share * by_a * scale * model.by_number[i][b];
    }
  }
  for (std::size_t a = 0; a < n; ++a)
    for (std::size_t b = 0; b < n; ++b) {
      const double precision = tables.prior_precision(a, b);
      const double off = coordinates[b] - tables.prior_mean[b];
      result.value += 0.5 * (coordinates[a] - tables.prior_mean[a]) * precision * off;
      result.gradient[a] += precision * off;
      if (b <= a) result.curvature[a][b] += precision;
    }
  return result;
}

}  // namespace

void LocalModel::predict(std::span<const double> coordinates) {
  std::ranges::fill(reflectance, 0.0);
  std::ranges::fill(by_number, TexelNumbers{});
  skin_.set(coordinates);
  for (std::size_t w = 0; w < tables_->wavelengths.size(); ++w) {
    const LayerAbsorption absorption = skin_.absorption(tables_->spectra[w]);
    const LocalReflectance::Value value = tables_->reflectance->at(w, absorption.sigma_a);
    TexelNumbers by = {};
    for (std::size_t n = 0; n < coordinates.size(); ++n)
      by[n] = value.by_sigma_a[0] * absorption.by_number[0][n] +
              value.by_sigma_a[1] * absorption.by_number[1][n];
    for (std::size_t i = 0; i < capture_->images.size(); ++i) {
      const double weight = capture_->images[i].sensor[w];
      if (weight == 0.0) continue;
      reflectance[i] += weight * (value.reflectance + tables_->missed[w]);
      for (std::size_t n = 0; n < coordinates.size(); ++n) by_number[i][n] += weight * by[n];
    }
  }
}

TexelNumbers fit_texel(LocalModel& model, const TexelData& data, const InversionTables& tables,
                       std::span<const double> start, double robust_limit) {
  SmallFit<most_free_numbers> fit{.size = start.size()};
  fit.scale.fill(1.0);
  std::ranges::copy(start, fit.at.begin());
  fit.run(
      [&](const TexelNumbers& at) {
        return objective_at(model, data, tables, std::span(at).first(fit.size), robust_limit);
      },
      [&](std::size_t a, double x) { return coordinate_in_range(tables.numbers[a].parameter, x); },
      [](std::size_t, double, double) { return false; }, [] {});
  return fit.at;
}

TexelMatrix texel_covariance(LocalModel& model, const TexelData& data,
                             const InversionTables& tables, std::span<const double> coordinates,
                             double robust_limit) {
  return small_covariance(objective_at(model, data, tables, coordinates, robust_limit).curvature,
                          coordinates.size());
}

}  // namespace lamina::detail

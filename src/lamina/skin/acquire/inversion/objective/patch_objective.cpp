// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/acquire/inversion/objective/patch_objective.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lamina/base/core/parallel.h"
#include "lamina/skin/acquire/inversion/objective/half_grid.h"

namespace lamina::detail {
PatchObjective::PatchObjective(const PatchCapture& capture, const InversionTables& tables,
                               const InversionOptions& options, PatchLight& light)
    : capture_(capture),
      tables_(tables),
      light_(light),
      robust_limit_(options.robust_limit),
      smoothness_(tables.numbers.size()),
      prior_precision_(tables.prior_precision) {
  for (const PatchImage& image : capture.images) {
    const Plane& arriving = capture.lights[image.light];
    double missed = 0.0;
    for (std::size_t w = 0; w < tables.wavelengths.size(); ++w)
      missed += std::pow(image.sensor[w] * tables.missed_deviation[w], 2);
    std::vector<float>& weights = weights_.emplace_back(image.reflected.values.size(), 0.0f);
    std::vector<float>& measured = measured_.emplace_back(weights.size(), 0.0f);
    double sum = 0.0, count = 0.0;
    for (std::size_t t = 0; t < weights.size(); ++t) {
      if (std::isinf(image.deviation.values[t]) || arriving.values[t] == 0.0f) continue;
      const double deviation =
          std::max(static_cast<double>(image.deviation.values[t]),
                   least_relative_deviation * static_cast<double>(arriving.values[t]));
      measured[t] = image.reflected.values[t];
      const auto value = static_cast<double>(measured[t]);
      const auto lit = static_cast<double>(arriving.values[t]);
      weights[t] = static_cast<float>(1.0 / std::sqrt(deviation * deviation + missed * lit * lit +
                                                      std::pow(options.model_error * value, 2)));
      sum += value;
      count += 1.0;
    }
    means_.push_back(count > 0.0 ? sum / count : 0.0);
    known_ += count;
  }
  growth_.assign(weights_.size(), 1.0);
  if (!options.error_growth.empty()) set_error_growth(options.error_growth);
}

void PatchObjective::set_error_growth(const std::vector<double>& growth) {
  for (std::size_t i = 0; i < weights_.size(); ++i) {
    const auto factor = static_cast<float>(growth_[i] / growth[i]);
    for (float& weight : weights_[i]) weight *= factor;
  }
  growth_ = growth;
}

std::vector<BandMisfit> PatchObjective::misfit(const PatchState& state,
                                               const std::vector<double>& leverage) const {
  std::vector<BandMisfit> result(weights_.size());
  for (std::size_t i = 0; i < weights_.size(); ++i) {
    BandMisfit& image = result[i];
    for (std::size_t t = 0; t < weights_[i].size(); ++t) {
      if (weights_[i][t] == 0.0f) continue;
      const double miss =
          static_cast<double>(weights_[i][t] * (state.images[i][t] - measured_[i][t]));
      image.squares += share_of(miss) * miss * miss;
      image.count += 1.0;
    }
    image.squares *= growth_[i] * growth_[i];
    image.left = image.count - leverage[i];
  }
  return result;
}

void PatchObjective::set_smoothness(std::vector<MapSmoothness> smoothness) {
  smoothness_ = std::move(smoothness);
  const bool ties = std::ranges::all_of(smoothness_, [](const MapSmoothness& each) {
    return each.first.weight > 0.0 || each.third.weight > 0.0;
  });
  const double texels = std::max(1.0, known_ / static_cast<double>(weights_.size()));
  prior_precision_ = tables_.prior_precision;
  if (ties)
    for (double& value : prior_precision_.values) value /= texels;
}

TexelMaps PatchObjective::off_prior(const TexelMaps& coordinates) const {
  TexelMaps off = coordinates;
  for (std::size_t n = 0; n < off.size(); ++n)
    for (float& value : off[n]) value -= static_cast<float>(tables_.prior_mean[n]);
  return off;
}

double PatchObjective::objective(const PatchState& state) const {
  double sum = 0.0;
  for (std::size_t i = 0; i < weights_.size(); ++i)
    for (std::size_t t = 0; t < weights_[i].size(); ++t) {
      const double size =
          std::abs(static_cast<double>(weights_[i][t] * (state.images[i][t] - measured_[i][t])));
      sum += robust_limit_ > 0.0 && size > robust_limit_
                 ? robust_limit_ * (size - 0.5 * robust_limit_)
                 : 0.5 * size * size;
    }
  std::vector<double> rough(smoothness_.size());
  parallel_for(rough.size(), [&](std::size_t n) {
    rough[n] = roughness(size(), smoothness_[n], state.coordinates[n]);
  });
  for (const double value : rough) sum += 0.5 * value;
  const TexelMaps off = off_prior(state.coordinates);
  for (std::size_t a = 0; a < off.size(); ++a)
    for (std::size_t b = 0; b < off.size(); ++b) {
      const double precision = prior_precision_(a, b);
      if (precision == 0.0) continue;
      double products = 0.0;
      for (std::size_t t = 0; t < off[a].size(); ++t)
        products += static_cast<double>(off[a][t]) * static_cast<double>(off[b][t]);
      sum += 0.5 * precision * products;
    }
  return sum;
}

PatchState PatchObjective::state(TexelMaps coordinates) const {
  TexelMaps images = light_.images(coordinates);
  return state(std::move(coordinates), std::move(images));
}

PatchState PatchObjective::state(TexelMaps coordinates, TexelMaps images) const {
  PatchState state{.coordinates = std::move(coordinates), .images = std::move(images)};
  state.objective = objective(state);
  double relative = 0.0, squares = 0.0, used = 0.0;
  for (std::size_t i = 0; i < weights_.size(); ++i) {
    double sum = 0.0, count = 0.0;
    for (std::size_t t = 0; t < weights_[i].size(); ++t) {
      if (weights_[i][t] == 0.0f) continue;
      const auto miss = static_cast<double>(state.images[i][t] - measured_[i][t]);
      sum += miss * miss;
      squares += std::pow(static_cast<double>(weights_[i][t]) * miss, 2);
      count += 1.0;
    }
    if (count == 0.0 || !(means_[i] > 0.0)) continue;
    relative += sum / count / (means_[i] * means_[i]);
    used += 1.0;
  }
  state.residual = used > 0.0 ? std::sqrt(relative / used) : 0.0;
  state.in_deviations = std::sqrt(squares / known_);
  return state;
}

void PatchObjective::add_prior_matrix(const TexelMaps& change, TexelMaps& sum) const {
  parallel_for(change.size(), [&](std::size_t n) {
    std::vector<float>& to = sum[n];
    add_roughness_matrix(size(), smoothness_[n], change[n], to);
    for (std::size_t m = 0; m < change.size(); ++m) {
      const auto precision = static_cast<float>(prior_precision_(n, m));
      if (precision == 0.0f) continue;
      for (std::size_t t = 0; t < to.size(); ++t) to[t] += precision * change[m][t];
    }
  });
}

TexelMaps PatchObjective::gradient(const PatchState& state) const {
  TexelMaps by_images = weights_;
  for (std::size_t i = 0; i < by_images.size(); ++i)
    for (std::size_t t = 0; t < by_images[i].size(); ++t) {
      const float weight = weights_[i][t];
      float miss = weight * (state.images[i][t] - measured_[i][t]);
      const auto limit = static_cast<float>(robust_limit_);
      if (limit > 0.0f && std::abs(miss) > limit) miss = std::copysign(limit, miss);
      by_images[i][t] = weight * miss;
    }
  TexelMaps result = light_.gradient(by_images);
  add_prior_matrix(off_prior(state.coordinates), result);
  return result;
}

void PatchObjective::linearize(const PatchState& state) {
  shares_ = weights_;
  for (std::size_t i = 0; i < shares_.size(); ++i)
    for (std::size_t t = 0; t < shares_[i].size(); ++t)
      shares_[i][t] = static_cast<float>(
          share_of(static_cast<double>(weights_[i][t] * (state.images[i][t] - measured_[i][t]))));
}

double PatchObjective::share_of(double miss) const {
  const double size = std::abs(miss);
  return robust_limit_ > 0.0 && size > robust_limit_ ? robust_limit_ / size : 1.0;
}

TexelMaps PatchObjective::times_matrix(const TexelMaps& change) const {
  TexelMaps images = light_.change(change);
  for (std::size_t i = 0; i < images.size(); ++i)
    for (std::size_t t = 0; t < images[i].size(); ++t)
      images[i][t] *= weights_[i][t] * weights_[i][t] * shares_[i][t];
  TexelMaps result = light_.gradient(images);
  add_prior_matrix(change, result);
  return result;
}

}  // namespace lamina::detail

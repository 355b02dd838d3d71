// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/exchange/internal/shared_gaussians.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "lamina/solve/scattering/profile/gaussian_fit.h"

namespace lamina::detail {
namespace {

/// Flux beyond radii, and the radii, of a channel.
struct FluxBeyond {
  std::vector<double> r, flux;
  double total = 0.0;
};

FluxBeyond flux_beyond(const Profile& profile, std::size_t channel, bool reflected) {
  const FluxCurve curve =
      reflected ? reflected_flux(profile, channel) : transmitted_flux(profile, channel);
  FluxBeyond result;
  result.total =
      reflected ? profile.total_reflectance[channel] : profile.total_transmittance[channel];
  result.total = std::max(result.total, 0.0);
  const double sum = curve.within.back() + curve.beyond;
  const double scale = sum > 0.0 ? result.total / sum : 0.0;  // to the total, which is known better
  result.r.push_back(0.0);
  result.flux.push_back(result.total);
  constexpr std::size_t stride = 2;
  for (std::size_t i = 0; i < profile.r.size(); i += stride) {
    result.r.push_back(profile.r[i]);
    result.flux.push_back(std::clamp(scale * (sum - curve.within[i]), 0.0, result.total));
  }
  return result;
}

struct Trial {
  SharedGaussians sums;
  double squares = 0.0;
};

Trial fit_between(const std::vector<FluxBeyond>& channels, double first, double last, int count) {
  Trial trial;
  std::vector<double> inverse;  // of the variances, ascending
  for (int i = 0; i < count; ++i) {
    const double place = count > 1 ? static_cast<double>(i) / (count - 1) : 0.5;
    trial.sums.variances.push_back(first * std::pow(last / first, place));
  }
  for (const double variance : trial.sums.variances) inverse.push_back(1.0 / variance);
  std::ranges::reverse(inverse);
  for (const FluxBeyond& channel : channels) {
    if (!(channel.total > 0.0)) {
      trial.sums.weights.emplace_back(inverse.size(), 0.0);
      continue;
    }
    GaussianFit fit = fit_gaussians(channel.flux, channel.r, inverse);
    double sum = 0.0;
    for (const double weight : fit.sum.weights) sum += weight;
    for (double& weight : fit.sum.weights) weight *= channel.total / sum;  // colors must be right
    trial.sums.weights.emplace_back(fit.sum.weights.rbegin(), fit.sum.weights.rend());
    for (std::size_t i = 0; i < channel.r.size(); ++i) {
      const double error =
          (evaluate_at_frequency(fit.sum, channel.r[i]) - channel.flux[i]) / channel.total;
      trial.sums.largest_error = std::max(trial.sums.largest_error, std::abs(error));
      trial.squares += error * error;
    }
  }
  return trial;
}

}  // namespace

SharedGaussians fit_shared_gaussians(const Profile& profile, bool reflected, int count) {
  std::vector<FluxBeyond> channels;
  double narrow = std::numeric_limits<double>::infinity(), wide = 0.0;
  for (std::size_t c = 0; c < profile.bands; ++c) {
    channels.push_back(flux_beyond(profile, c, reflected));
    const FluxBeyond& channel = channels.back();
    const auto radius_of = [&](double part) {
      std::size_t i = 0;
      while (i + 1 < channel.r.size() && channel.flux[i] > part * channel.total) ++i;
      return std::max(channel.r[i], profile.r.front());
    };
    constexpr double inner = 0.95, outer = 0.02;  // of the flux that is to leave farther out
    narrow = std::min(narrow, radius_of(inner));
    wide = std::max(wide, radius_of(outer));
  }
  // The ends of the series: the best of ever finer steps around the best so far.
  double log_first = 2.0 * std::log(narrow),
         log_last = 2.0 * std::log(std::max(wide, 2.0 * narrow));
  Trial best = fit_between(channels, std::exp(log_first), std::exp(log_last), count);
  for (double step = 1.6; step > 0.05; step *= 0.5) {
    bool has_moved = true;
    for (int round = 0; has_moved && round < 8; ++round) {
      has_moved = false;
      for (const auto& [first, last] : {std::pair{step, 0.0}, std::pair{-step, 0.0},
                                        std::pair{0.0, step}, std::pair{0.0, -step}}) {
        if (log_last + last < log_first + first + 0.5) continue;
        Trial trial =
            fit_between(channels, std::exp(log_first + first), std::exp(log_last + last), count);
        if (trial.squares >= best.squares) continue;
        best = std::move(trial);
        log_first += first;
        log_last += last;
        has_moved = true;
      }
    }
  }
  return best.sums;
}

}  // namespace lamina::detail

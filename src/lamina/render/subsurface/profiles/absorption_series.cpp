// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/profiles/absorption_series.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "lamina/base/core/bracketed_root.h"
#include "lamina/solve/reflectance/material_totals.h"

namespace lamina {
namespace {

constexpr double step = 0.5 * std::numbers::ln2;
constexpr double lowest = -26.0 * std::numbers::ln2, highest = 20.0 * std::numbers::ln2;

double depth_of(double reflectance) {
  return std::log(-std::log(std::clamp(reflectance, 1e-12, 1.0 - 1e-9)));
}

/// Whether a node and the one before it have what is asked for between them in each band.
template <class IsPast>
bool have_all(const Profile& last, const Profile& before, const IsPast& is_past) {
  for (std::size_t b = 0; b < last.bands; ++b)
    if (!is_past(last.total_reflectance[b], b) || !is_past(before.total_reflectance[b], b))
      return false;
  return true;
}

}  // namespace

void AbsorptionSeries::start(std::span<const LayerStack> stacks) {
  stacks_.assign(stacks.begin(), stacks.end());
}

// One node more than is needed lies at each end, so that the slopes of the cubic are centred.
bool AbsorptionSeries::needs_brighter(const Wanted& wanted) const {
  if (size() < 2) return true;
  if (log_factors_.front() <= lowest) return false;
  return !have_all(profiles_[0], profiles_[1], [&](double total, std::size_t b) {
    return total >= std::min(wanted.brightest[b], most);
  });
}

bool AbsorptionSeries::needs_darker(const Wanted& wanted) const {
  if (log_factors_.back() >= highest) return false;
  return !have_all(profiles_[size() - 1], profiles_[size() - 2], [&](double total, std::size_t b) {
    return total <= std::max(wanted.darkest[b], least);
  });
}

std::vector<LayerStack> AbsorptionSeries::with_log_factor(double log_factor) const {
  std::vector<LayerStack> result;
  for (const LayerStack& stack : stacks_)
    result.push_back(with_absorption(stack, std::exp(log_factor)));
  return result;
}

std::vector<LayerStack> AbsorptionSeries::layers(std::size_t node) const {
  return with_log_factor(log_factors_[node]);
}

std::vector<LayerStack> AbsorptionSeries::next_brighter() const {
  return with_log_factor(log_factors_.empty() ? 0.0 : log_factors_.front() - step);
}

std::vector<LayerStack> AbsorptionSeries::next_darker() const {
  return with_log_factor(log_factors_.back() + step);
}

void AbsorptionSeries::add_brighter(Profile profile) {
  log_factors_.insert(log_factors_.begin(),
                      log_factors_.empty() ? 0.0 : log_factors_.front() - step);
  profiles_.insert(profiles_.begin(), std::move(profile));
}

void AbsorptionSeries::add_darker(Profile profile) {
  log_factors_.push_back(log_factors_.back() + step);
  profiles_.push_back(std::move(profile));
}

void AbsorptionSeries::finish() {
  for (const Profile& profile : profiles_)
    for (const double total : profile.total_reflectance) depths_.push_back(depth_of(total));
}

double AbsorptionSeries::factor(double reflectance, std::size_t band) const {
  const double wanted = depth_of(reflectance);
  std::size_t i = 0;
  while (i + 2 < size() && depth(i + 1, band) < wanted) ++i;
  const auto slope = [&](std::size_t k) {  // per step
    const std::size_t before = k > 0 ? k - 1 : k, after = std::min(k + 1, size() - 1);
    return (depth(after, band) - depth(before, band)) / static_cast<double>(after - before);
  };
  const double y0 = depth(i, band), y1 = depth(i + 1, band), m0 = slope(i), m1 = slope(i + 1);
  const auto cubic = [&](double t) {  // Hermite's
    const double s = 1.0 - t;
    return s * s * ((1.0 + 2.0 * t) * y0 + t * m0) + t * t * ((1.0 + 2.0 * s) * y1 - s * m1);
  };
  const double t =
      falling_root([&](double at) { return wanted - cubic(at); }, 0.0, 1.0, 1e-9).place;
  return std::exp(log_factors_[i] + t * step);
}

}  // namespace lamina

// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/reflectance/material_totals.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "lamina/core/parallel.h"
#include "lamina/scattering/adding_doubling/adding_doubling.h"

namespace lamina {
namespace {

constexpr double least_total = 1e-9;
constexpr double least_factor = 1.0 / 64.0, largest_factor = 3000.0;  // of absorption

/// The factor on the absorption of one band at which a reflectance is met.
double factor_for(const Material& material, std::size_t band, double reflectance) {
  const auto excess = [&](double log_factor) {
    std::vector<double> factor(material.bands.size(), 1.0);
    factor[band] = std::exp(log_factor);
    return exact_totals(with_absorption(material, factor), band).reflectance - reflectance;
  };
  double light = std::log(least_factor), dark = std::log(largest_factor);
  double at_light = excess(light), at_dark = excess(dark);
  if (at_light <= 0.0) return least_factor;
  if (at_dark >= 0.0) return largest_factor;
  // Regula falsi; an end that stays twice counts half (the Illinois rule).
  double log_factor = light, last = 0.0;
  for (int step = 0; step < 60; ++step) {
    log_factor = (light * at_dark - dark * at_light) / (at_dark - at_light);
    const double value = excess(log_factor);
    if (std::abs(value) < 1e-6) break;
    const bool is_same_side = value * last > 0.0;
    last = value;
    if (value > 0.0) {
      light = log_factor, at_light = value;
      if (is_same_side) at_dark *= 0.5;
    } else {
      dark = log_factor, at_dark = value;
      if (is_same_side) at_light *= 0.5;
    }
  }
  return std::exp(log_factor);
}

}  // namespace

LayerStack stack_with_smooth_ends(const Material& material, std::size_t band) {
  const LayerStack stack = layer_stack(material, band);
  std::vector<Layer> layers(stack.layers().begin(), stack.layers().end());
  layers.front().top.roughness = 0.0;
  Ground ground = stack.ground();
  ground.top.roughness = 0.0;
  return LayerStack(std::move(layers), stack.ior_above(), stack.ior_below(), ground);
}

EnteredTotals exact_totals(const Material& material, std::size_t band) {
  const SlabTotals totals =
      adding_doubling(stack_with_smooth_ends(material, band), {.is_diffuse = true}).totals;
  const double entered = 1.0 - totals.specular_reflectance;
  return {totals.diffuse_reflectance / entered, totals.transmittance / entered};
}

std::vector<EnteredTotals> exact_totals(const Material& material) {
  std::vector<EnteredTotals> totals(material.bands.size());
  parallel_for(totals.size(), [&](std::size_t b) { totals[b] = exact_totals(material, b); });
  return totals;
}

Profile with_exact_totals(Profile profile, const Material& material) {
  assert(profile.per == ProfilePer::entered_flux);
  const std::vector<EnteredTotals> exact = exact_totals(material);
  for (std::size_t b = 0; b < profile.bands; ++b) {
    const auto scale = [&](std::vector<double>& values, double& total, double wanted) {
      if (!(total > least_total)) return;
      for (std::size_t i = b; i < values.size(); i += profile.bands) values[i] *= wanted / total;
      total = wanted;
    };
    scale(profile.reflectance_profile, profile.total_reflectance[b], exact[b].reflectance);
    scale(profile.transmittance_profile, profile.total_transmittance[b], exact[b].transmittance);
  }
  return profile;
}

double thickness_of_upper_layers(const Material& material) {
  double total = 0.0;
  for (std::size_t i = 0; i + 1 < material.layers.size(); ++i)
    total += material.layers[i].thickness;
  return total;
}

Material make_slab(const Material& material, double thickness) {
  Material slab = material;
  const std::size_t upper = material.layers.size() - 1;
  slab.layers.back().thickness =
      std::max(thickness - 2.0 * thickness_of_upper_layers(material), 0.1 * thickness);
  for (std::size_t i = upper; i-- > 0;) {
    MaterialLayer layer = material.layers[i];
    layer.top = material.layers[i + 1].top;
    slab.layers.push_back(layer);
  }
  slab.ground = {.top = material.layers.front().top};
  slab.ior_below = material.ior_above;
  return slab;
}

Material with_absorption(Material material, const std::vector<double>& factor) {
  assert(factor.size() == material.bands.size());
  for (MaterialLayer& layer : material.layers) {
    for (std::size_t b = 0; b < layer.sigma_a.size(); ++b)
      layer.sigma_a[b] =
          factor[b] * std::max(layer.sigma_a[b], 1e-3 * layer.sigma_s[b] * (1.0 - layer.g[b]));
    for (MixturePart& part : layer.mixture)
      for (std::size_t b = 0; b < part.sigma_a.size(); ++b) part.sigma_a[b] *= factor[b];
  }
  return material;
}

Material with_reflectance(const Material& material, const std::vector<double>& reflectance) {
  assert(reflectance.size() == material.bands.size());
  const std::vector<EnteredTotals> own = exact_totals(material);
  const auto stays = [&](std::size_t b) {
    return std::abs(own[b].reflectance - reflectance[b]) < 1e-5;
  };
  std::vector<double> factor(reflectance.size(), 1.0);
  parallel_for(factor.size(), [&](std::size_t b) {
    if (!stays(b)) factor[b] = factor_for(material, b, reflectance[b]);
  });
  Material result = with_absorption(material, factor);
  for (std::size_t i = 0; i < result.layers.size(); ++i)
    for (std::size_t b = 0; b < result.layers[i].sigma_a.size(); ++b)
      if (stays(b)) result.layers[i].sigma_a[b] = material.layers[i].sigma_a[b];
  return result;
}

}  // namespace lamina

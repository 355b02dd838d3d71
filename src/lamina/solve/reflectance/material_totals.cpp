// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/reflectance/material_totals.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "lamina/base/core/bracketed_root.h"
#include "lamina/base/core/parallel.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"

namespace lamina {
namespace {

constexpr double least_total = 1e-9;
constexpr double least_factor = 1.0 / 64.0, largest_factor = 3000.0;  // of absorption

/// The same of a material, of all that its layers are mixed of; a factor for each band.
Material with_absorptions(Material material, const std::vector<double>& factor) {
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

/// The factor on the absorption of one band at which a reflectance is met.
double factor_for(const Material& material, std::size_t band, double reflectance) {
  const auto excess = [&](double log_factor) {
    std::vector<double> factor(material.bands.size(), 1.0);
    factor[band] = std::exp(log_factor);
    const LayerStack layers = layer_stack(with_absorptions(material, factor), band);
    return material_totals(layers).reflectance - reflectance;
  };
  return std::exp(
      falling_root(excess, std::log(least_factor), std::log(largest_factor), 1e-6).place);
}

}  // namespace

LayerStack with_smooth_ends(const LayerStack& stack) {
  std::vector<Layer> layers(stack.layers().begin(), stack.layers().end());
  layers.front().top.roughness = 0.0;
  Ground ground = stack.ground();
  ground.top.roughness = 0.0;
  return LayerStack(std::move(layers), stack.ior_above(), stack.ior_below(), ground);
}

LayerStack with_smooth_bottom(const LayerStack& stack) {
  Ground ground = stack.ground();
  ground.top.roughness = 0.0;
  return LayerStack({stack.layers().begin(), stack.layers().end()}, stack.ior_above(),
                    stack.ior_below(), ground);
}

EnteredTotals material_totals(const LayerStack& layers) {
  const SlabTotals totals = adding_doubling(with_smooth_ends(layers), {.is_diffuse = true}).totals;
  const double entered = 1.0 - totals.specular_reflectance;
  return {totals.diffuse_reflectance / entered, totals.transmittance / entered};
}

std::vector<EnteredTotals> material_totals(std::span<const LayerStack> bands) {
  std::vector<EnteredTotals> totals(bands.size());
  parallel_for(totals.size(), [&](std::size_t b) { totals[b] = material_totals(bands[b]); });
  return totals;
}

Profile with_material_totals(Profile profile, std::span<const LayerStack> bands) {
  assert(profile.per == ProfilePer::entered_flux);
  const std::vector<EnteredTotals> wanted_totals = material_totals(bands);
  for (std::size_t b = 0; b < profile.bands; ++b) {
    const auto scale = [&](std::vector<double>& values, double& total, double wanted) {
      if (!(total > least_total)) return;
      for (std::size_t i = b; i < values.size(); i += profile.bands) values[i] *= wanted / total;
      total = wanted;
    };
    scale(profile.reflectance_profile, profile.total_reflectance[b], wanted_totals[b].reflectance);
    scale(profile.transmittance_profile, profile.total_transmittance[b],
          wanted_totals[b].transmittance);
  }
  return profile;
}

LayerStack with_absorption(const LayerStack& stack, double factor) {
  std::vector<Layer> layers(stack.layers().begin(), stack.layers().end());
  for (Layer& layer : layers) {
    Medium& medium = layer.medium;
    medium.sigma_a = factor * std::max(medium.sigma_a, 1e-3 * medium.sigma_s * (1.0 - medium.g));
  }
  return LayerStack(std::move(layers), stack.ior_above(), stack.ior_below(), stack.ground());
}

Material with_reflectance(const Material& material, const std::vector<double>& reflectance) {
  assert(reflectance.size() == material.bands.size());
  const std::vector<EnteredTotals> own = material_totals(layer_stacks(material));
  const auto stays = [&](std::size_t b) {
    return std::abs(own[b].reflectance - reflectance[b]) < 1e-5;
  };
  std::vector<double> factor(reflectance.size(), 1.0);
  parallel_for(factor.size(), [&](std::size_t b) {
    if (!stays(b)) factor[b] = factor_for(material, b, reflectance[b]);
  });
  Material result = with_absorptions(material, factor);
  for (std::size_t i = 0; i < result.layers.size(); ++i)
    for (std::size_t b = 0; b < result.layers[i].sigma_a.size(); ++b)
      if (stays(b)) result.layers[i].sigma_a[b] = material.layers[i].sigma_a[b];
  return result;
}

}  // namespace lamina

// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/layers/optics/layer_stack.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <string>
#include <variant>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"

namespace lamina {
namespace {

void require(bool holds, const std::string& where, const std::string& rule, double given) {
  if (holds) return;
  PlainTextStream message;
  message << where << ": " << rule << ", but is " << given;
  throw InvalidInput(message.str());
}

bool is_finite_and_nonnegative(double x) { return std::isfinite(x) && x >= 0.0; }

void check(const Interface& interface, const std::string& where) {
  require(interface.roughness >= 0.0 && interface.roughness <= 1.0, where,
          "roughness must lie in [0, 1]", interface.roughness);
}

void check(const HenyeyGreenstein& lobe, const std::string& where) {
  require(-1.0 < lobe.g && lobe.g < 1.0, where, "g must lie in (-1, 1)", lobe.g);
}

void check(const Rayleigh& /*lobe*/, const std::string& /*where*/) {}

void check(const PhaseMixture& mixture, const std::string& where) {
  double sum = 0.0;
  for (const auto& lobe : mixture.lobes) {
    require(lobe.weight > 0.0, where, "the weight of a phase function must be > 0", lobe.weight);
    std::visit([&](const auto& one) { check(one, where); }, lobe.phase);
    sum += lobe.weight;
  }
  require(std::abs(sum - 1.0) < 1e-9, where, "the weights of phase functions must sum to 1", sum);
}

void check(const Layer& layer, std::size_t index, bool is_bottom) {
  const std::string where = "layer " + std::to_string(index);
  const auto& [sigma_a, sigma_s, g, ior] = layer.medium;
  require(is_finite_and_nonnegative(sigma_a), where, "sigma_a must be >= 0 [1/mm]", sigma_a);
  require(is_finite_and_nonnegative(sigma_s), where, "sigma_s must be >= 0 [1/mm]", sigma_s);
  require(-1.0 < g && g < 1.0, where, "g must lie in (-1, 1)", g);
  require(std::isfinite(ior) && ior > 0.0, where, "ior must be > 0", ior);
  require(layer.thickness > 0.0, where, "thickness must be > 0 [mm]", layer.thickness);
  require(std::isfinite(layer.thickness) || is_bottom, where,
          "thickness must be finite above the bottom layer [mm]", layer.thickness);
  check(layer.top, where);
  if (!layer.phase) return;
  std::visit([&](const auto& kind) { check(kind, where); }, *layer.phase);
  const double mean = mean_cosine(*layer.phase);
  require(std::abs(mean - g) < 1e-9, where,
          "g must be the mean cosine of the phase function, " + number_text(mean), g);
}

}  // namespace

LayerStack::LayerStack(std::vector<Layer> layers, double ior_above, double ior_below, Ground ground)
    : layers_(std::move(layers)), ior_above_(ior_above), ior_below_(ior_below), ground_(ground) {
  if (layers_.empty()) throw InvalidInput("layers: at least one is required, but there are 0");
  for (std::size_t i = 0; i < layers_.size(); ++i) check(layers_[i], i, i + 1 == layers_.size());
  require(std::isfinite(ior_above) && ior_above > 0.0, "ior_above", "must be > 0", ior_above);
  require(std::isfinite(ior_below) && ior_below > 0.0, "ior_below", "must be > 0", ior_below);
  require(ground.reflectance >= 0.0 && ground.reflectance <= 1.0, "ground",
          "reflectance must lie in [0, 1]", ground.reflectance);
  check(ground.top, "ground");
  if (is_semi_infinite(*this)) ior_below_ = layers_.back().medium.ior;
}

bool is_smooth(const LayerStack& stack) {
  return stack.ground().top.roughness == 0.0 &&
         std::ranges::all_of(stack.layers(),
                             [](const Layer& layer) { return layer.top.roughness == 0.0; });
}

LayerStack flipped(const LayerStack& stack) {
  assert(!is_semi_infinite(stack) && stack.ground().reflectance == 0.0);
  std::vector<Layer> layers(stack.layers().rbegin(), stack.layers().rend());
  for (std::size_t i = 0; i < layers.size(); ++i)
    layers[i].top = i == 0 ? stack.ground().top : stack.layers()[layers.size() - i].top;
  return LayerStack(std::move(layers), stack.ior_below(), stack.ior_above(),
                    {.top = stack.layers()[0].top});
}

}  // namespace lamina

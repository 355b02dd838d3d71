// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/random_walk/internal/walk_layers.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <variant>

#include "lamina/core/error.h"
#include "lamina/optics/same_ior.h"
#include "lamina/reflectance/exact_totals.h"
#include "lamina/render/subsurface/colored_transport.h"
#include "lamina/render/subsurface/random_walk/internal/walk_turn.h"
#include "lamina/scattering/layered_bsdf/first_order-inl.h"

namespace lamina {
namespace {

constexpr float beyond_measure = 1e9f;

/// Nothing but an index, in the bands of the scene.
Material clear_medium(const Scene& scene, const DielectricSurface& glass) {
  Material clear;
  for (const SurfaceMaterial& material : scene.materials)
    if (const auto* other = std::get_if<SubsurfaceSurface>(&material.surface))
      clear.bands = other->material.bands;
  const std::vector<double> zero(clear.bands.size(), 0.0);
  const std::vector<double> ior(clear.bands.size(), static_cast<double>(glass.ior));
  clear.ior_above.assign(clear.bands.size(), 1.0);
  clear.ior_below = ior;
  clear.layers = {{.sigma_a = zero, .sigma_s = zero, .g = zero, .ior = ior}};
  const double roughness =
      glass.smoothness ? 2.0 / std::max(glass.smoothness->value, 0.1f) : glass.roughness.value;
  clear.layers[0].top = {std::clamp(roughness, 0.0, 1.0), glass.distribution};
  return clear;
}

/// The layers of a material as they lie inside a mesh.
template <int N>
Material inside_mesh(const RenderScene& scene, const BandConversion<N>& conversion,
                     std::uint32_t material) {
  const auto& surface = scene.scene->materials[material].surface;
  if (const auto* glass = std::get_if<DielectricSurface>(&surface))
    return clear_medium(*scene.scene, *glass);
  return colored_medium<N>(scene, conversion, material);
}

std::vector<float> thickness_of_layers(const Material& material) {
  std::vector<float> thickness;
  for (std::size_t i = 0; i + 1 < material.layers.size(); ++i)
    thickness.push_back(static_cast<float>(material.layers[i].thickness));
  return thickness;
}

NodeLattice lattice_for(const RenderScene& scene, std::uint32_t material,
                        const std::vector<float>& thickness) {
  const Box box = box_of_material(*scene.scene, material);
  const float thinnest = thickness.empty() ? 1.0f : *std::ranges::min_element(thickness);
  return {box.low, box.high, thinnest, 5e5};
}

}  // namespace

template <int N>
WalkLayers<N>::WalkLayers(const RenderScene& scene, const BandConversion<N>& conversion,
                          std::uint32_t material)
    : WalkLayers(scene, material, inside_mesh<N>(scene, conversion, material)) {}

template <int N>
WalkLayers<N>::WalkLayers(const RenderScene& scene, std::uint32_t material, const Material& inside)
    : by_depth_(scene.geometry, scene.scene->meshes, material, thickness_of_layers(inside),
                lattice_for(scene, material, thickness_of_layers(inside))),
      bands_(static_cast<int>(inside.bands.size())) {
  Material smooth = inside;  // what the phase functions are taken from has no rough boundaries
  for (MaterialLayer& layer : smooth.layers) layer.top = {};
  std::vector<LayerStack> stacks;
  for (std::size_t b = 0; b < inside.bands.size(); ++b) {
    stacks.push_back(layer_stack(smooth, b));
    ior_ += static_cast<float>(inside.layers[0].ior[b] / inside.ior_above[b]) /
            static_cast<float>(bands_);
    reflectance_[static_cast<int>(b)] = static_cast<float>(exact_totals(smooth, b).reflectance);
  }
  stack_ = make_first_order<N>(stacks);
  least_extinction_ = Bands::filled(std::numeric_limits<float>::infinity());
  for (std::size_t i = 0; i < inside.layers.size(); ++i) {
    const Bands& sigma_t = stack_.layers[i].sigma_t;
    Layer layer{.medium = make_walk_medium(stack_.layers[i].sigma_s, sigma_t, bands_)};
    for (const LayerStack& stack : stacks)
      layer.phases.push_back(phase_function(stack.layers()[i]));
    for (const PhaseFunction& phase : layer.phases)
      layer.is_same_phase = layer.is_same_phase && phase == layer.phases[0];
    layer.least_extinction = *std::min_element(sigma_t.v, sigma_t.v + bands_);
    layer.top = inside.layers[i].top;
    for (const double ior : inside.layers[i].ior)
      layer.ior += static_cast<float>(ior) / static_cast<float>(bands_);
    if (i > 0) {
      const Layer& above = layers_[i - 1];
      if (is_same_ior(layer.ior, above.ior)) layer.ior = above.ior;
      layer.sees_out = above.sees_out && layer.ior == above.ior;
    }
    if (i > 0)
      layer.least_depth =
          layers_[i - 1].least_depth +
          layers_[i - 1].least_extinction * static_cast<float>(inside.layers[i - 1].thickness);
    least_extinction_ = min(least_extinction_, sigma_t);
    layers_.push_back(std::move(layer));
  }
}

template <int N>
float WalkLayers<N>::shortest_free_path() const {
  float most = 1e-6f;
  for (const Layer& layer : layers_) most = std::max(most, largest(layer.medium.sigma_t));
  return 1.0f / most;
}

template <int N>
BandValues<N> WalkLayers<N>::optical_thickness(const Ray& way, const DepthLayers::Place& start,
                                               float length) const {
  Bands sum;
  by_depth_.for_parts(way, start, length, [&](std::size_t layer, float part) {
    const bool is_straight = layers_[layer].ior == layers_[start.layer].ior;
    sum += is_straight ? part * layers_[layer].medium.sigma_t : Bands::filled(beyond_measure);
    return is_straight;
  });
  return sum;
}

template <int N>
float WalkLayers<N>::least_optical_depth(const DepthLayers::Place& place) const {
  const Layer& layer = layers_[place.layer];
  return layer.least_depth +
         layer.least_extinction * std::max(place.depth - by_depth_.top(place.layer), 0.0f);
}

template <int N>
BandValues<N> WalkLayers<N>::phase(std::size_t layer, float one_minus_cos) const {
  return first_order::layer_phase(stack_, stack_.layers[layer], Bands::filled(one_minus_cos));
}

template <int N>
void WalkLayers<N>::scatter(std::size_t layer, WalkPath<N>& path, WalkNumbers& numbers) const {
  turn_at_event(path, layers_[layer].phases, layers_[layer].is_same_phase, numbers,
                [&](float one_minus_cos) { return phase(layer, one_minus_cos); });
}

template class WalkLayers<4>;
template class WalkLayers<8>;
template class WalkLayers<16>;

}  // namespace lamina

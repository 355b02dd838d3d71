// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/random_walk/internal/walk_layers.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <variant>

#include "lamina/core/error.h"
#include "lamina/core/float_pi.h"
#include "lamina/optics/same_ior.h"
#include "lamina/reflectance/material_totals.h"
#include "lamina/render/subsurface/profiles/colored_transport.h"
#include "lamina/render/subsurface/random_walk/internal/body_interior.h"
#include "lamina/scattering/layered_bsdf/first_order.h"

namespace lamina {
namespace {

constexpr float huge = 1e9f;

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
  double ior = 0.0;
  for (std::size_t b = 0; b < inside.bands.size(); ++b) {
    stacks.push_back(layer_stack(smooth, b));
    ior += inside.layers[0].ior[b] / inside.ior_above[b] / static_cast<double>(bands_);
    reflectance_[static_cast<int>(b)] =
        static_cast<float>(material_totals(stacks.back()).reflectance);
  }
  ior_ = static_cast<float>(ior);
  stack_ = make_first_order<N>(stacks);
  least_extinction_ = Bands::filled(std::numeric_limits<float>::infinity());
  for (std::size_t i = 0; i < inside.layers.size(); ++i) {
    const Bands& sigma_t = stack_.layers[i].sigma_t;
    Layer layer{.medium = make_walk_medium(stack_.layers[i].sigma_s, sigma_t, bands_)};
    for (const LayerStack& stack : stacks)
      layer.phases.push_back(phase_function(stack.layers()[i]));
    for (const PhaseFunction& phase : layer.phases)
      layer.is_same_phase = layer.is_same_phase && phase == layer.phases[0];
    layer.is_isotropic =
        layer.is_same_phase && layer.phases[0] == PhaseFunction(HenyeyGreenstein{.g = 0.0});
    layer.least_extinction = *std::min_element(sigma_t.v, sigma_t.v + bands_);
    layer.top = inside.layers[i].top;
    for (const double of_band : inside.layers[i].ior)
      layer.ior += static_cast<float>(of_band) / static_cast<float>(bands_);
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
BandValues<N> WalkLayers<N>::optical_thickness(const Ray& ray, const DepthLayers::Place& start,
                                               float length) const {
  Bands sum;
  by_depth_.for_parts(ray, start, length, [&](std::size_t layer, float part) {
    const bool is_straight = layers_[layer].ior == layers_[start.layer].ior;
    sum += is_straight ? part * layers_[layer].medium.sigma_t : Bands::filled(huge);
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
  if (layers_[layer].is_isotropic) return Bands::filled(0.25f / float_pi);
  return layer_phase(stack_, stack_.layers[layer], Bands::filled(one_minus_cos));
}

template <int N>
BandValues<N> WalkLayers<N>::mean_cosine(std::size_t layer) const {
  Bands result;
  for (int b = 0; b < N; ++b)
    result[b] = static_cast<float>(lamina::mean_cosine(
        layers_[layer].phases[static_cast<std::size_t>(std::min(b, bands_ - 1))]));
  return result;
}

template <int N>
void WalkLayers<N>::sample_phase(std::size_t layer, WalkPath<N>& path, WalkNumbers& numbers) const {
  const std::vector<PhaseFunction>& phases = layers_[layer].phases;
  const bool is_same = layers_[layer].is_same_phase;
  const Vec2f u = numbers.pair();
  const float phi = 2.0f * float_pi * u.y;
  if (layers_[layer].is_isotropic) {
    const float z = 1.0f - 2.0f * u.x, r = std::sqrt(std::max(1.0f - z * z, 0.0f));
    path.ray.direction = {r * std::cos(phi), r * std::sin(phi), z};
    return;
  }
  const int band =
      is_same ? 0 : sample_band(path.throughput, bands_, numbers.stream().uniform_float());
  const double cosine = sample_cos_theta(phases[static_cast<std::size_t>(band)],
                                         static_cast<double>(u.x), numbers.stream().uniform());
  const auto cos_theta = static_cast<float>(cosine),
             one_minus_cos = static_cast<float>(1.0 - cosine);
  const float sin_theta = std::sqrt(one_minus_cos * (1.0f + cos_theta));
  const Framef frame = make_frame(path.ray.direction);
  path.ray.direction =
      normalize(frame.to_world({sin_theta * std::cos(phi), sin_theta * std::sin(phi), cos_theta}));
  if (is_same) return;
  const Bands turned = path.throughput * phase(layer, one_minus_cos);
  float before = 0.0f, density = 0.0f;
  for (int b = 0; b < bands_; ++b) {
    before += path.throughput[b];
    density += turned[b];
  }
  path.throughput = (before / density) * turned;
}

template class WalkLayers<4>;
template class WalkLayers<8>;
template class WalkLayers<16>;

}  // namespace lamina

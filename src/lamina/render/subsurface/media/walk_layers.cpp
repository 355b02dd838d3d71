// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/media/walk_layers.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <variant>

#include "lamina/base/core/error.h"
#include "lamina/base/core/float_pi.h"
#include "lamina/layers/optics/henyey_greenstein.h"
#include "lamina/layers/optics/same_ior.h"
#include "lamina/render/subsurface/bodies/closed_bodies.h"
#include "lamina/render/subsurface/media/quiet_layers.h"
#include "lamina/render/subsurface/profiles/colored_transport.h"
#include "lamina/solve/reflectance/material_totals.h"
#include "lamina/solve/scattering/layered_bsdf/first_order.h"

namespace lamina {
namespace {

constexpr float huge = 1e9f;
// Of boundaries of layers, over the thickness of the thinnest.
constexpr float tolerance = 0.005f, quiet_tolerance = 0.01f;
constexpr float least_crossing_cosine = 1e-6f;  // at which light crosses a sheet

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
                     std::uint32_t material, bool is_quiet) {
  const auto& surface = scene.scene->materials[material].surface;
  if (const auto* glass = std::get_if<DielectricSurface>(&surface))
    return clear_medium(*scene.scene, *glass);
  Material medium = colored_medium<N>(scene, conversion, material);
  return is_quiet ? quiet_layers(std::move(medium)) : medium;
}

std::span<const MaterialMap> maps_of(const Scene& scene, std::uint32_t material) {
  const auto* surface = std::get_if<SubsurfaceSurface>(&scene.materials[material].surface);
  if (!surface) return {};
  return surface->material_maps;
}

NodeLattice lattice_for(const RenderScene& scene, std::uint32_t material,
                        const DepthLayers::Thickness& thickness) {
  const Box box = box_of_material(*scene.scene, material);
  float thinnest = thickness.layers.empty() ? 1.0f : std::numeric_limits<float>::infinity();
  for (const std::vector<float>& layer : thickness.layers)
    thinnest = std::min(thinnest, *std::ranges::max_element(layer));
  return {box.low, box.high, thinnest, 5e5};
}

}  // namespace

template <int N>
WalkLayers<N>::WalkLayers(const RenderScene& scene, const BandConversion<N>& conversion,
                          std::uint32_t material, bool is_quiet)
    : WalkLayers(scene, material,
                 with_sheets(inside_mesh<N>(scene, conversion, material, is_quiet)),
                 is_quiet ? quiet_tolerance : tolerance) {}

template <int N>
WalkLayers<N>::WalkLayers(const RenderScene& scene, std::uint32_t material,
                          const SheetedLayers& sheeted, float tolerance)
    : maps_(std::make_shared<const LayerMaps<N>>(
          make_layer_maps<N>(sheeted, maps_of(*scene.scene, material)))),
      by_depth_(std::make_shared<const DepthLayers>(
          scene.geometry, scene.scene->meshes, material, maps_->thickness,
          lattice_for(scene, material, maps_->thickness), tolerance)),
      bands_(static_cast<int>(sheeted.layers.bands.size())) {
  const Material& inside = sheeted.layers;
  // What the phase functions are taken from has no rough boundaries.
  Material whole = sheeted.whole, layers = inside;
  for (Material* smooth : {&whole, &layers})
    for (MaterialLayer& layer : smooth->layers) layer.top = {};
  std::vector<LayerStack> stacks;
  double ior = 0.0;
  for (std::size_t b = 0; b < inside.bands.size(); ++b) {
    stacks.push_back(layer_stack(layers, b));
    ior += inside.layers[0].ior[b] / inside.ior_above[b] / static_cast<double>(bands_);
    reflectance_[static_cast<int>(b)] =
        static_cast<float>(material_totals(layer_stack(whole, b)).reflectance);
  }
  ior_ = static_cast<float>(ior);
  stack_ = make_first_order<N>(stacks);
  for (std::size_t i = 0; i < inside.layers.size(); ++i) {
    const auto& of_maps = maps_->layers[i];
    const Bands& least = of_maps.least_extinction;
    Layer layer{.medium =
                    make_walk_medium(of_maps.sigma_s.front(), of_maps.sigma_t.front(), bands_)};
    for (const LayerStack& stack : stacks)
      layer.phases.push_back(phase_function(stack.layers()[i]));
    for (int b = 0; b < N; ++b)
      layer.mean_cosine[b] = static_cast<float>(
          lamina::mean_cosine(layer.phases[static_cast<std::size_t>(std::min(b, bands_ - 1))]));
    layer.true_mean_cosine = layer.mean_cosine;
    layer.most = of_maps.most_extinction;
    layer.least = least;
    for (const PhaseFunction& phase : layer.phases)
      layer.is_same_phase = layer.is_same_phase && phase == layer.phases[0];
    layer.is_isotropic =
        layer.is_same_phase && layer.phases[0] == PhaseFunction(HenyeyGreenstein{.g = 0.0});
    layer.least_extinction = *std::min_element(least.v, least.v + bands_);
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
          layers_[i - 1].least_extinction * (by_depth_->least_top(i) - by_depth_->least_top(i - 1));
    layers_.push_back(std::move(layer));
  }
}

template <int N>
WalkLayers<N> WalkLayers<N>::with_even_scattering() const {
  WalkLayers even = *this;
  even.is_even_ = true;
  for (std::size_t i = 0; i < layers_.size(); ++i) {
    const auto& [sigma_s, sigma_t, g, sheet, most, least] = maps_->layers[i];
    Layer& layer = even.layers_[i];
    const auto reduced = [&](std::size_t texel) {
      return sigma_t[sigma_t.size() > 1 ? texel : 0] - taken_off(i, texel);
    };
    layer.most = layer.least = reduced(0);
    for (std::size_t texel = 1; texel < std::max({sigma_s.size(), sigma_t.size(), g.size()});
         ++texel) {
      layer.most = max(layer.most, reduced(texel));
      layer.least = min(layer.least, reduced(texel));
    }
    const Bands off = taken_off(i, 0);
    layer.medium = make_walk_medium(sigma_s.front() - off, sigma_t.front() - off, bands_);
    layer.phases.assign(layer.phases.size(), HenyeyGreenstein{.g = 0.0});
    layer.mean_cosine = {};
    layer.is_same_phase = layer.is_isotropic = true;
    layer.least_extinction = *std::min_element(layer.least.v, layer.least.v + bands_);
    if (i > 0) {
      const Layer& above = even.layers_[i - 1];
      layer.least_depth =
          above.least_depth +
          above.least_extinction * (by_depth_->least_top(i) - by_depth_->least_top(i - 1));
    }
  }
  return even;
}

template <int N>
BandValues<N> WalkLayers<N>::extinction(std::size_t layer, Vec2f uv) const {
  const auto& [sigma_s, sigma_t, g, sheet, most, least] = maps_->layers[layer];
  const TexelGrid& grid = by_depth_->grid();
  Bands here = sigma_t.size() == 1 ? sigma_t[0] : grid.around(uv).mean(sigma_t);
  if (!is_even_) return here;
  if (sigma_s.size() == 1 && g.empty()) return here - taken_off(layer, 0);
  const TexelGrid::Around around = grid.around(uv);
  for (std::size_t i = 0; i < 4; ++i)
    here += (-around.weight[i]) * taken_off(layer, around.texel[i]);
  return here;
}

template <int N>
float WalkLayers<N>::shortest_free_path() const {
  float most = 1e-6f;
  for (const auto& layer : maps_->layers) most = std::max(most, largest(layer.most_extinction));
  return 1.0f / most;
}

template <int N>
float WalkLayers<N>::shortest_reduced_free_path() const {
  const std::size_t last = layers_.size() - 1;
  return 1.0f / std::max(largest(maps_->layers[last].sigma_t.front() - taken_off(last, 0)), 1e-6f);
}

template <int N>
BandValues<N> WalkLayers<N>::optical_depth(const Place& place) const {
  const std::size_t texel = by_depth_->grid().sample(place.uv, 0.5f);
  const auto at = [&](const auto& values) { return values[values.size() > 1 ? texel : 0]; };
  Bands depth;
  for (std::size_t i = 0; i <= place.layer; ++i) {
    const auto& layer = maps_->layers[i];
    const float top = by_depth_->top_at(i, texel);
    const float bottom = i < place.layer ? by_depth_->top_at(i + 1, texel) : place.depth;
    const Bands off = is_even_ ? taken_off(i, texel) : Bands{};
    depth += std::max(bottom - top, 0.0f) * (at(layer.sigma_t) - off);
    if (layer.has_sheet()) depth += at(layer.sheet);
  }
  return depth;
}

template <int N>
BandValues<N> WalkLayers<N>::crossing_thickness(std::size_t from, const Crossing& crossing,
                                                const Vec3f& direction) const {
  const auto& layer = maps_->layers[std::max(from, crossing.place.layer)];
  if (!layer.has_sheet()) return {};
  const float cosine = std::abs(dot(direction, crossing.place.outward));
  return (1.0f / std::max(cosine, least_crossing_cosine)) *
         by_depth_->grid().around(crossing.place.uv).mean(layer.sheet);
}

template <int N>
BandValues<N> WalkLayers<N>::optical_thickness(const Ray& ray, const Place& start, float length,
                                               const Place& end) const {
  Bands sum;
  by_depth_->for_parts(
      ray, start, length, end,
      [&](const Place& place, float part) {
        sum += part * extinction(place.layer, start.uv);
        return true;
      },
      [&](std::size_t from, const Crossing& crossing) {
        const bool refracts = layers_[from].ior != layers_[crossing.place.layer].ior;
        sum += refracts ? Bands::filled(huge) : crossing_thickness(from, crossing, ray.direction);
        return !refracts;
      });
  return sum;
}

template <int N>
BandValues<N> WalkLayers<N>::sample_residual(const Ray& ray, const Place& start, float length,
                                             const Place& end, Random& random) const {
  Bands ratio = Bands::filled(1.0f);
  if (!has_maps()) return ratio;
  float begin = 0.0f;
  const auto along = [&](const Place& place, float part) {
    const std::size_t layer = place.layer;
    const float from = begin;
    begin += part;
    if (!is_mapped(layer)) return true;
    const Bands expected = extinction(layer, start.uv);
    const float most = largest(layers_[layer].most - layers_[layer].least);
    if (!(most > 0.0f)) return true;
    for (float t = 0.0f;;) {
      t -= std::log(1.0f - random.uniform_float()) / most;
      if (t > part) return true;
      const Place here = by_depth_->at(ray.origin + (from + t) * ray.direction, place);
      ratio *= Bands::filled(1.0f) - (1.0f / most) * (extinction(layer, here.uv) - expected);
    }
  };
  by_depth_->for_parts(ray, start, length, end, along,
                       [&](std::size_t from, const Crossing& crossing) {
                         return layers_[from].ior == layers_[crossing.place.layer].ior;
                       });
  return ratio;
}

template <int N>
float WalkLayers<N>::least_optical_depth(const Place& place) const {
  const Layer& layer = layers_[place.layer];
  return layer.least_depth +
         layer.least_extinction * std::max(place.depth - by_depth_->least_top(place.layer), 0.0f);
}

template <int N>
BandValues<N> WalkLayers<N>::phase(const Place& place, float one_minus_cos) const {
  if (const auto& g = maps_->layers[place.layer].g; !is_even_ && !g.empty()) {
    Bands result;
    for (int b = 0; b < N; ++b) result[b] = henyey_greenstein(g[place.texel][b], one_minus_cos);
    return result;
  }
  if (layers_[place.layer].is_isotropic) return Bands::filled(0.25f / float_pi);
  return layer_phase(stack_, stack_.layers[place.layer], Bands::filled(one_minus_cos));
}

template <int N>
void WalkLayers<N>::sample_phase(const Place& place, WalkPath<N>& path,
                                 WalkNumbers& numbers) const {
  const Layer& layer = layers_[place.layer];
  const auto& g = maps_->layers[place.layer].g;
  const bool has_map = !is_even_ && !g.empty();
  const bool is_same = layer.is_same_phase && !has_map;
  const Vec2f u = numbers.pair();
  const float phi = 2.0f * float_pi * u.y;
  if (layer.is_isotropic && !has_map) {
    const float z = 1.0f - 2.0f * u.x, r = std::sqrt(std::max(1.0f - z * z, 0.0f));
    path.ray.direction = {r * std::cos(phi), r * std::sin(phi), z};
    return;
  }
  const int band =
      is_same ? 0 : sample_band(path.throughput, bands_, numbers.stream().uniform_float());
  const double second = numbers.stream().uniform();
  const double cosine =
      !has_map ? sample_cos_theta(layer.phases[static_cast<std::size_t>(band)],
                                  static_cast<double>(u.x), second)
               : 1.0 - sample_henyey_greenstein(static_cast<double>(g[place.texel][band]),
                                                static_cast<double>(u.x));
  const auto cos_theta = static_cast<float>(cosine),
             one_minus_cos = static_cast<float>(1.0 - cosine);
  const float sin_theta = std::sqrt(one_minus_cos * (1.0f + cos_theta));
  const Framef frame = make_frame(path.ray.direction);
  path.ray.direction =
      normalize(frame.to_world({sin_theta * std::cos(phi), sin_theta * std::sin(phi), cos_theta}));
  if (is_same) return;
  const Bands turned = path.throughput * phase(place, one_minus_cos);
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

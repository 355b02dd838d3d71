// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/layered_bsdf/layered_material.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lamina/base/core/error.h"
#include "lamina/base/core/float_within.h"
#include "lamina/base/core/parallel.h"
#include "lamina/render/subsurface/profiles/colored_transport.h"
#include "lamina/scene/surface/map_range.h"

namespace lamina {
namespace {

using Quantity = LayerMap::Quantity;

/// What a quantity can be.
std::pair<float, float> limits(const LayerMap& map) {
  switch (map.quantity) {
    case Quantity::skin: {
      const SkinParameterRange& range = skin_parameter_ranges()[map.part];
      // Without absorption the junction is no layer, but the number of layers must stay.
      const bool is_junction = range.value == &SkinParameters::junction_absorption;
      return {is_junction ? 1e-6f : float_within(range.low, range.low, range.high),
              float_within(range.high, range.low, range.high)};
    }
    case Quantity::fraction:
      return {0.0f, 1.0f};
    case Quantity::thickness:
      return {1e-6f, 1e9f};
    default:
      return {0.0f, 1e6f};
  }
}

/// Makes room where the parts of a mixture ask for more than all of it.
float crowding(float total) { return total > 1.0f ? 1.0f / total : 1.0f; }

template <int N>
BandValues<N> to_bands(const std::vector<double>& values) {
  BandValues<N> bands;
  for (int b = 0; b < N; ++b)
    bands[b] = static_cast<float>(values[std::min(static_cast<std::size_t>(b), values.size() - 1)]);
  return bands;
}

}  // namespace

template <int N>
LayeredMaterial<N>::LayeredMaterial(const RenderScene& scene, const BandConversion<N>& conversion,
                                    std::uint32_t material)
    : scene_(scene),
      conversion_(conversion),
      surface_(std::get<SubsurfaceSurface>(scene.scene->materials[material].surface)),
      maps_(scene.layer_maps[material]),
      orders_(scene.settings.orders) {
  const auto require = [&](bool holds, const std::string& rule) {
    if (!holds)
      throw InvalidInput("material \"" + scene.scene->materials[material].name + "\": " + rule);
  };
  require(maps_.size() <= most_mapped, "at most 4 of its parameters can be mapped");
  for (const LayerMap& map : maps_) {
    const auto [least, most] = limits(map);
    auto [low, high] = range_of(scene.textures, map.terms);
    low = std::clamp(low, least, most);
    high = std::clamp(high, low, most);
    parameters_.push_back({&map, low, high});
  }
  if (surface_.color_use == SubsurfaceSurface::ColorUse::scale)
    mean_color_ = mean_of_map(scene.textures, surface_.color);
  try {
    make_stack();
  } catch (const InvalidInput& error) {
    require(false, error.what());
  }
  require(stack_.has_one_ior || orders_ != LayeredOrders::random_walk,
          "orders \"random_walk\" need refractive indices that are the same in all bands");
  make_table();
}

template <int N>
void LayeredMaterial<N>::make_stack() {
  const Material& material = surface_.material;
  stack_ = make_first_order<N>(layer_stacks(material));
  if (parameters_.empty() || has_skin_maps()) return;

  // Every part keeps its own lobe, since its share varies.
  std::size_t lobes = 0;
  for (const MaterialLayer& from : material.layers) {
    MixedLayer& to = layers_.emplace_back();
    const auto part = [](const auto& p, double fraction) {
      return Part{to_bands<N>(p.sigma_a), to_bands<N>(p.sigma_s), to_bands<N>(p.g),
                  static_cast<float>(fraction), p.phase == ParticlePhase::rayleigh};
    };
    for (const MixturePart& p : from.mixture) to.parts.push_back(part(p, p.fraction));
    if (!from.sigma_a.empty()) to.base = part(from, 0.0);
    lobes += to.parts.size() + (to.base ? 1 : 0);
  }
  for (const Parameter& parameter : parameters_) layers_[parameter.map->layer].is_mapped = true;
  InlineVector<PhaseLobe<Bands>, 6> all(lobes);
  std::size_t next = 0;
  for (std::size_t k = 0; k < layers_.size(); ++k) {
    FirstOrderLayer<Bands>& layer = stack_.layers[k];
    layer.first_lobe = next;
    const auto add = [&](const Part& part) {
      all[next++] = {.g = part.g, .is_rayleigh = part.is_rayleigh};
    };
    for (const Part& part : layers_[k].parts) add(part);
    if (layers_[k].base) add(*layers_[k].base);
    layer.lobes = next - layer.first_lobe;
    layers_[k].is_mapped = true;  // so that the new lobes get their weights
  }
  stack_.lobes = std::move(all);
  std::vector<float> values;
  for (const Parameter& parameter : parameters_) values.push_back(parameter.low);
  stack_ = stack_of(values);
  for (MixedLayer& layer : layers_) layer.is_mapped = false;
  for (const Parameter& parameter : parameters_) layers_[parameter.map->layer].is_mapped = true;
}

template <int N>
float LayeredMaterial<N>::value_of(const Parameter& parameter, const SurfacePoint& point) const {
  float value = 0.0f;
  for (const ScalarParameter& term : parameter.map->terms)
    value += scene_.textures.scalar(term, point);
  return std::clamp(value, parameter.low, parameter.high);
}

template <int N>
FirstOrderStack<BandValues<N>> LayeredMaterial<N>::stack_of(std::span<const float> values) const {
  if (!stacks_.empty()) return stack_between(values);
  FirstOrderStack<Bands> stack = stack_;
  for (std::size_t k = 0; k < layers_.size(); ++k) {
    const MixedLayer& mixed = layers_[k];
    if (!mixed.is_mapped) continue;
    FirstOrderLayer<Bands>& layer = stack.layers[k];
    InlineVector<float, 6> fractions(mixed.parts.size());
    for (std::size_t i = 0; i < fractions.size(); ++i) fractions[i] = mixed.parts[i].fraction;
    float scale_a = 1.0f, scale_s = 1.0f;
    for (std::size_t p = 0; p < parameters_.size(); ++p) {
      const LayerMap& map = *parameters_[p].map;
      if (map.layer != k) continue;
      if (map.quantity == Quantity::thickness) layer.thickness = Bands::filled(values[p]);
      if (map.quantity == Quantity::sigma_a) scale_a = values[p];
      if (map.quantity == Quantity::sigma_s) scale_s = values[p];
      if (map.quantity == Quantity::fraction) fractions[map.part] = values[p];
    }
    float total = 0.0f;
    for (std::size_t i = 0; i < fractions.size(); ++i) total += fractions[i];
    const float room = crowding(total);
    Bands sigma_a, sigma_s;
    std::size_t lobe = layer.first_lobe;
    const auto add = [&](const Part& part, float fraction) {
      sigma_a += fraction * part.sigma_a;
      stack.lobes[lobe].weight = fraction * part.sigma_s;
      sigma_s += stack.lobes[lobe++].weight;
    };
    for (std::size_t i = 0; i < fractions.size(); ++i) add(mixed.parts[i], room * fractions[i]);
    if (mixed.base) add(*mixed.base, std::max(1.0f - room * total, 0.0f));
    const Bands inverse = Bands::filled(1.0f) / max(sigma_s, Bands::filled(1e-30f));
    for (std::size_t l = layer.first_lobe; l < lobe; ++l) stack.lobes[l].weight *= inverse;
    layer.sigma_s = scale_s * sigma_s;
    layer.sigma_t = layer.sigma_s + scale_a * sigma_a;
  }
  return stack;
}

template <int N>
std::unique_ptr<LayeredPoint<N>> LayeredMaterial<N>::at(const SurfacePoint& point,
                                                        const SurfaceBoundary& boundary,
                                                        const Vec3f& wo) const {
  typename LayeredPoint<N>::Layers layers;
  const SurfaceMaterial& material = scene_.scene->materials[point.material];
  layers.is_bare = !material.coat && surface_.material.layers.front().top.roughness == 0.0;
  layers.orders = orders_;
  layers.factors = scene_.settings.factors;
  if (parameters_.empty()) {
    layers.stack = stack_;
    layers.higher = &table_.front();
  } else {
    std::array<float, most_mapped> values{};
    for (std::size_t p = 0; p < parameters_.size(); ++p)
      values[p] = value_of(parameters_[p], point);
    const std::span<const float> used(values.data(), parameters_.size());
    layers.stack = stack_of(used);
    layers.own = higher_of(used);
  }
  if (surface_.color_use == SubsurfaceSurface::ColorUse::scale) {
    const Vec3f c = scene_.textures.color(surface_.color, point);
    layers.color = conversion_.from_rgb({std::max(c.x / mean_color_.x, 0.0f),
                                         std::max(c.y / mean_color_.y, 0.0f),
                                         std::max(c.z / mean_color_.z, 0.0f)});
  }
  return std::make_unique<LayeredPoint<N>>(std::move(layers), boundary, wo);
}

template class LayeredMaterial<4>;
template class LayeredMaterial<8>;
template class LayeredMaterial<16>;

}  // namespace lamina

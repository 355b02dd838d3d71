// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// The table of a layered material over the quantities that maps vary.
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <utility>

#include "lamina/base/core/parallel.h"
#include "lamina/render/subsurface/layered_bsdf/layered_material.h"

namespace lamina {
namespace {

using Quantity = LayerMap::Quantity;

bool is_of_skin(const LayerMap& map) { return map.quantity == Quantity::skin; }

/// The material with its mapped quantities at given values.
Material with_values(Material material, std::span<const LayerMap> maps,
                     std::span<const double> values) {
  if (std::ranges::any_of(maps, is_of_skin)) {
    for (std::size_t p = 0; p < maps.size(); ++p) {
      if (!is_of_skin(maps[p])) continue;
      const SkinParameterRange& range = skin_parameter_ranges()[maps[p].part];
      material.skin->skin.*range.value = std::clamp(values[p], range.low, range.high);
    }
    std::vector<MaterialLayer> layers =
        skin_layers(material.skin->skin, material.bands.wavelengths());
    assert(layers.size() == material.layers.size());
    for (std::size_t k = 0; k < layers.size(); ++k) layers[k].top = material.layers[k].top;
    material.layers = std::move(layers);
  }
  for (std::size_t p = 0; p < maps.size(); ++p) {
    MaterialLayer& layer = material.layers[maps[p].layer];
    switch (maps[p].quantity) {
      case Quantity::thickness:
        layer.thickness = values[p];
        break;
      case Quantity::sigma_a:
        for (double& sigma : layer.sigma_a) sigma *= values[p];
        for (MixturePart& part : layer.mixture)
          for (double& sigma : part.sigma_a) sigma *= values[p];
        break;
      case Quantity::sigma_s:
        for (double& sigma : layer.sigma_s) sigma *= values[p];
        for (MixturePart& part : layer.mixture)
          for (double& sigma : part.sigma_s) sigma *= values[p];
        break;
      case Quantity::fraction:
        layer.mixture[maps[p].part].fraction = values[p];
        break;
      case Quantity::skin:
        break;
    }
  }
  for (MaterialLayer& layer : material.layers) {
    double total = 0.0;
    for (const MixturePart& part : layer.mixture) total += part.fraction;
    if (total > 1.0)
      for (MixturePart& part : layer.mixture) part.fraction /= total;
  }
  return material;
}

/// Values at which the table has rows crowd at the low end: reflectance goes with roots.
double row_value(float low, float high, int row, int rows) {
  const double t = rows > 1 ? static_cast<double>(row) / (rows - 1) : 0.0;
  return static_cast<double>(low) + t * t * static_cast<double>(high - low);
}

}  // namespace

template <int N>
bool LayeredMaterial<N>::has_skin_maps() const {
  return std::ranges::any_of(maps_, is_of_skin);
}

template <int N>
void LayeredMaterial<N>::make_table() {
  const Material& material = surface_.material;
  constexpr std::array<int, most_mapped + 1> rows_for = {1, 17, 9, 6, 4};
  rows_ = rows_for[parameters_.size()];
  std::size_t entries = 1;
  for (std::size_t p = 0; p < parameters_.size(); ++p) entries *= static_cast<std::size_t>(rows_);
  table_.resize(entries);
  const bool has_stacks = has_skin_maps();
  if (has_stacks) stacks_.resize(entries);
  parallel_for(entries, [&](std::size_t entry) {
    std::vector<double> values;
    std::size_t rest = entry;
    for (const Parameter& parameter : parameters_) {
      const int row = static_cast<int>(rest % static_cast<std::size_t>(rows_));
      rest /= static_cast<std::size_t>(rows_);
      values.push_back(row_value(parameter.low, parameter.high, row, rows_));
    }
    const Material here = with_values(material, maps_, values);
    const std::vector<LayerStack> stacks = layer_stacks(here);
    std::vector<HigherOrders> bands;
    for (const LayerStack& stack : stacks) bands.push_back(make_higher_orders(stack, 3e-4));
    table_[entry] = make_higher_order_bands<N>(bands);
    if (has_stacks) stacks_[entry] = make_first_order<N>(stacks);
  });
}

template <int N>
template <class Take>
void LayeredMaterial<N>::for_corners(std::span<const float> values, const Take& take) const {
  std::array<std::size_t, most_mapped> row{};
  std::array<float, most_mapped> blend{};
  for (std::size_t p = 0; p < values.size(); ++p) {
    const auto& [map, low, high] = parameters_[p];
    const float t = high > low ? std::sqrt(std::max(values[p] - low, 0.0f) / (high - low)) : 0.0f;
    const float x = t * static_cast<float>(rows_ - 1);
    const int i = std::clamp(static_cast<int>(x), 0, rows_ - 2);
    row[p] = static_cast<std::size_t>(i);
    // Linear in the value, between rows that are not.
    const auto at = [&](int r) { return static_cast<float>(row_value(low, high, r, rows_)); };
    blend[p] =
        high > low ? std::clamp((values[p] - at(i)) / (at(i + 1) - at(i)), 0.0f, 1.0f) : 0.0f;
  }
  for (std::size_t corner = 0; corner < (std::size_t{1} << values.size()); ++corner) {
    std::size_t entry = 0, stride = 1;
    float weight = 1.0f;
    for (std::size_t p = 0; p < values.size(); ++p) {
      const bool is_next = (corner >> p) & 1u;
      weight *= is_next ? blend[p] : 1.0f - blend[p];
      entry += stride * (row[p] + (is_next ? 1 : 0));
      stride *= static_cast<std::size_t>(rows_);
    }
    if (weight != 0.0f) take(entry, weight);
  }
}

/// Linear in what the table's rows hold: exact for the coefficients of a recipe, which are sums of
/// products of its numbers, but for a power of the wavelength.
template <int N>
FirstOrderStack<BandValues<N>> LayeredMaterial<N>::stack_between(
    std::span<const float> values) const {
  FirstOrderStack<Bands> stack = stacks_.front();
  for (std::size_t k = 0; k < stack.layers.size(); ++k) {
    FirstOrderLayer<Bands>& layer = stack.layers[k];
    layer.sigma_s = layer.sigma_t = layer.thickness = Bands{};
    for_corners(values, [&](std::size_t entry, float weight) {
      const FirstOrderLayer<Bands>& from = stacks_[entry].layers[k];
      layer.sigma_s += weight * from.sigma_s;
      layer.sigma_t += weight * from.sigma_t;
      layer.thickness += weight * from.thickness;
    });
  }
  return stack;
}

template <int N>
HigherOrderBands<N> LayeredMaterial<N>::higher_of(std::span<const float> values) const {
  HigherOrderBands<N> result;  // of light from above; nothing leaves below
  for_corners(values, [&](std::size_t entry, float weight) {
    const HigherOrderBands<N>& from = table_[entry];
    for (std::size_t a = 0; a < result.above.size(); ++a) {
      result.above[a] += weight * from.above[a];
      result.reflected[a] += weight * from.reflected[a];
    }
    result.mean_above += weight * from.mean_above;
  });
  return result;
}

template class LayeredMaterial<4>;
template class LayeredMaterial<8>;
template class LayeredMaterial<16>;

}  // namespace lamina

// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "lamina/base/io/nearest_name.h"
#include "lamina/scene/description/internal/scene_file.h"

namespace lamina::scene_file {
namespace {

/// The entry of that name, or of that number; its index in `named`.
template <class Named>
std::optional<std::size_t> find(const std::vector<Named>& named, const std::string& name) {
  for (std::size_t i = 0; i < named.size(); ++i)
    if (named[i].name == name || std::to_string(i) == name) return i;
  return std::nullopt;
}

}  // namespace

LayerMap find_quantity(const JsonInput& value, const std::string& key, const Material& material) {
  // What can be mapped, as the file may name it.
  std::vector<std::string> known;
  for (std::size_t k = 0; k < material.layers.size(); ++k) {
    const MaterialLayer& layer = material.layers[k];
    const std::string prefix = (layer.name.empty() ? std::to_string(k) : layer.name) + ".";
    for (std::size_t i = 0; i < layer.mixture.size(); ++i)
      known.push_back(prefix +
                      (layer.mixture[i].name.empty() ? std::to_string(i) : layer.mixture[i].name));
    if (std::isfinite(layer.thickness)) known.push_back(prefix + "thickness");
    known.push_back(prefix + "sigma_a");
    known.push_back(prefix + "sigma_s");
  }
  if (material.skin)
    for (const SkinParameterRange& range : skin_parameter_ranges())
      if (std::isfinite(material.skin->skin.*range.value)) known.emplace_back(range.name);
  const auto refuse = [&]() {
    std::string list;
    for (const std::string& name : known) list += (list.empty() ? "\"" : ", \"") + name + "\"";
    const std::vector<std::string_view> names(known.begin(), known.end());
    value.fail("names no quantity of the material, which has " + list + did_you_mean(key, names));
  };
  if (material.skin)
    for (std::size_t i = 0; i < skin_parameter_ranges().size(); ++i) {
      const SkinParameterRange& range = skin_parameter_ranges()[i];
      if (range.name != key) continue;
      if (std::isinf(material.skin->skin.*range.value)) value.fail("the layer is infinitely thick");
      if (range.value == &SkinParameters::junction_absorption &&
          !(material.skin->skin.junction_absorption > 0.0))
        value.fail("the recipe has no junction, whose absorption it gives as 0");
      return {.quantity = LayerMap::Quantity::skin, .part = i};
    }
  const std::size_t dot = key.rfind('.');
  if (dot == std::string::npos) refuse();
  const std::string quantity = key.substr(dot + 1);
  const auto layer = find(material.layers, key.substr(0, dot));
  if (!layer) refuse();
  LayerMap map{.layer = *layer};
  using Quantity = LayerMap::Quantity;
  const MaterialLayer& from = material.layers[*layer];
  if (const auto part = find(from.mixture, quantity)) {
    map.part = *part;
  } else if (quantity == "thickness") {
    if (!std::isfinite(from.thickness)) value.fail("the layer is infinitely thick");
    map.quantity = Quantity::thickness;
  } else if (quantity == "sigma_a") {
    map.quantity = Quantity::sigma_a;
  } else if (quantity == "sigma_s") {
    map.quantity = Quantity::sigma_s;
  } else {
    refuse();
  }
  if (map.quantity == Quantity::fraction && from.sigma_a.empty())
    value.fail("the mixture has nothing that fills the rest of the volume");
  return map;
}

}  // namespace lamina::scene_file

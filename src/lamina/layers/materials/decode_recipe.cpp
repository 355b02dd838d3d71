// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0

#include "lamina/base/core/number_text.h"
#include "lamina/layers/materials/material_file.h"

namespace lamina::material_file {

bool is_map(const JsonInput& value, const Context& context) {
  if (!value.is_object()) return false;
  if (context.maps) return true;
  if (value.peek("map") || value.peek("noise"))
    value.fail("maps are for patches and scenes only; give a number");
  return false;
}

double mappable_number(const JsonInput& value, const MappableNumber& number,
                       const Context& context) {
  if (is_map(value, context)) return context.maps(number, value).front();
  return value.number(closed_interval(number.low, number.high));
}

double mappable_length(const JsonInput& value, MappableNumber number, const Context& context) {
  if (!is_map(value, context)) return plain_length(value, number.low, number.high, context);
  number.unit = context.mm_per_unit;
  return context.maps(number, value).front();
}

double plain_number(const JsonInput& value, const NumberRange& range) {
  if (value.is_object() && value.peek("map")) value.fail("cannot be a map; give a number");
  return value.number(range);
}

double plain_length(const JsonInput& value, double low, double high, const Context& context) {
  return context.mm_per_unit *
         plain_number(value, closed_interval(low / context.mm_per_unit, high / context.mm_per_unit,
                                             context.length_unit));
}

void require_wavelengths(const JsonInput& recipe, const Context& context, double shortest,
                         double longest) {
  for (const double wavelength : context.wavelengths) {
    if (shortest <= wavelength && wavelength <= longest) continue;
    PlainTextStream message;
    message << "knows wavelengths in [" << shortest << ", " << longest << "] nm, but \"bands\" has "
            << wavelength;
    recipe.fail(message.str());
  }
}

std::vector<MaterialLayer> material_layers(std::span<const LayerStack> bands,
                                           const std::vector<std::string>& names) {
  std::vector<MaterialLayer> layers(names.size());
  for (std::size_t i = 0; i < layers.size(); ++i) {
    layers[i].name = names[i];
    layers[i].thickness = bands.front().layers()[i].thickness;
    for (const LayerStack& stack : bands) {
      const Medium& medium = stack.layers()[i].medium;
      layers[i].sigma_a.push_back(medium.sigma_a);
      layers[i].sigma_s.push_back(medium.sigma_s);
      layers[i].g.push_back(medium.g);
      layers[i].ior.push_back(medium.ior);
    }
  }
  return layers;
}

void add_to_source(Material& material, const std::string& text) {
  material.source += (material.source.empty() ? "" : "; ") + text;
}

}  // namespace lamina::material_file

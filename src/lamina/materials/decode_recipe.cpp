// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0

#include "lamina/core/number_text.h"
#include "lamina/materials/material_file.h"

namespace lamina::material_file {

double recipe_number(const JsonInput& value, const NumberRange& range) {
  if (value.is_object() && value.peek("map"))
    value.fail("maps are for the recipe \"skin\" of a scene only; give a number");
  return value.number(range);
}

double recipe_length(const JsonInput& value, double low, double high, const Context& context) {
  return context.mm_per_unit *
         recipe_number(value, closed_interval(low / context.mm_per_unit, high / context.mm_per_unit,
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

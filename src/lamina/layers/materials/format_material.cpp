// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>

#include "lamina/base/core/number_text.h"
#include "lamina/base/io/json_output.h"
#include "lamina/layers/materials/material.h"

namespace lamina {
namespace {

/// One number if all bands have the same.
std::string per_band(const std::vector<double>& values) {
  if (!values.empty() &&
      std::ranges::all_of(values, [&](double value) { return value == values[0]; }))
    return number_text(values[0]);
  std::string list = "[";
  for (const double value : values) list += (list.size() > 1 ? ", " : "") + number_text(value);
  return list + "]";
}

using Entries = std::vector<std::string>;  // `"key": value`

std::string entry(const std::string& key, const std::string& value) {
  return '"' + key + "\": " + value;
}

void add_interface(Entries& entries, const Interface& interface) {
  if (interface.roughness == 0.0) return;
  entries.push_back(entry("roughness", number_text(interface.roughness)));
  if (interface.distribution != Interface().distribution)
    entries.push_back(entry("distribution", json_quoted(name_of(interface.distribution))));
}

/// The coefficients of a MaterialLayer or a MixturePart.
void add_substance(Entries& entries, const auto& substance) {
  entries.push_back(entry("sigma_a", per_band(substance.sigma_a)));
  entries.push_back(entry("sigma_s", per_band(substance.sigma_s)));
  if (substance.phase == ParticlePhase::rayleigh)
    entries.push_back(entry("phase", json_quoted(name_of(substance.phase))));
  else
    entries.push_back(entry("g", per_band(substance.g)));
}

std::string join(const Entries& entries, const std::string& separator) {
  std::string text;
  for (const std::string& one : entries) text += (text.empty() ? "" : separator) + one;
  return text;
}

std::string one_line(const Entries& entries) { return "{ " + join(entries, ", ") + " }"; }

std::string format_part(const MixturePart& part) {
  Entries entries;
  if (!part.name.empty()) entries.push_back(entry("name", json_quoted(part.name)));
  entries.push_back(entry("fraction", number_text(part.fraction)));
  add_substance(entries, part);
  return "        " + one_line(entries);
}

std::string format_layer(const MaterialLayer& layer, bool is_top) {
  Entries entries;
  if (!layer.name.empty()) entries.push_back(entry("name", json_quoted(layer.name)));
  if (!layer.sigma_a.empty()) add_substance(entries, layer);
  if (!layer.mixture.empty()) {
    Entries parts;
    for (const MixturePart& part : layer.mixture) parts.push_back(format_part(part));
    entries.push_back(entry("mixture", "[\n" + join(parts, ",\n") + "\n      ]"));
  }
  entries.push_back(entry("ior", per_band(layer.ior)));
  entries.push_back(entry("thickness", std::isinf(layer.thickness) ? json_quoted("infinite")
                                                                   : number_text(layer.thickness)));
  if (!is_top) add_interface(entries, layer.top);
  return "    {\n      " + join(entries, ",\n      ") + "\n    }";
}

std::string format_bands(const BandSet& bands) {
  if (bands.is_rgb()) return json_quoted("rgb");
  Entries wavelengths;
  for (const double wavelength : bands.wavelengths())
    wavelengths.push_back(number_text(wavelength));
  return "[" + join(wavelengths, ", ") + "]";
}

}  // namespace

std::string format_material(const Material& material) {
  Entries file = {entry("lamina", json_quoted("material")), entry("version", "1")};
  if (!material.name.empty()) file.push_back(entry("name", json_quoted(material.name)));
  if (!material.source.empty()) file.push_back(entry("source", json_quoted(material.source)));
  file.push_back(entry("length_unit", json_quoted("mm")));
  file.push_back(entry("bands", format_bands(material.bands)));
  file.push_back(entry("ior_above", per_band(material.ior_above)));
  Entries surface, ground, layers;
  for (const MaterialLayer& layer : material.layers)
    layers.push_back(format_layer(layer, layers.empty()));
  if (!material.layers.empty()) {
    if (!std::isinf(material.layers.back().thickness)) {
      file.push_back(entry("ior_below", per_band(material.ior_below)));
      if (material.ground.reflectance != 0.0)
        ground.push_back(entry("reflectance", number_text(material.ground.reflectance)));
      add_interface(ground, material.ground.top);
    }
    const Interface& top = material.layers.front().top;
    add_interface(surface, top);
    if (material.specular_roughness) {
      if (surface.empty()) surface.push_back(entry("roughness", "0"));
      surface.push_back(entry("specular_roughness", number_text(*material.specular_roughness)));
    }
  }
  if (!surface.empty()) file.push_back(entry("surface", one_line(surface)));
  if (!ground.empty()) file.push_back(entry("ground", one_line(ground)));
  if (material.oiliness != 0.0) file.push_back(entry("oiliness", number_text(material.oiliness)));
  file.push_back(entry("layers", "[\n" + join(layers, ",\n") + "\n  ]"));
  return "{\n  " + join(file, ",\n  ") + "\n}\n";
}

}  // namespace lamina

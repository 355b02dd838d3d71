// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "material.h"

#include <pybind11/stl.h>

#include <string>
#include <vector>

#include "arrays.h"
#include "lamina/base/core/error.h"
#include "lamina/base/io/json_input.h"
#include "lamina/layers/materials/builtin_texts.h"
#include "lamina/layers/materials/material.h"
#include "lamina/layers/materials/material_file.h"
#include "lamina/scene/description/swatch_scene.h"
#include "layer_stacks.h"
#include "natives.h"

namespace lamina::python {
namespace {

/// The text of a dict, or of a pickle. What a message says of a line in it helps nobody.
Material decode_text(const std::string& text, const std::string& name,
                     const std::vector<double>& wavelengths) {
  const std::string place = name + ":1: ";
  try {
    const JsonDocument document = parse_json(text, name);
    return decode_material(document.root(), {}, wavelengths);
  } catch (const InvalidInput& error) {
    const std::string message = error.what();
    if (!message.starts_with(place)) throw;
    throw InvalidInput(name + ": " + message.substr(place.size()));
  }
}

std::vector<std::string> layer_names(const Material& material) {
  std::vector<std::string> names;
  for (const MaterialLayer& layer : material.layers) names.push_back(layer.name);
  return names;
}

}  // namespace

void bind_material(py::module_& module) {
  native_class<Material>(module, "Material")
      .def_readonly("name", &Material::name)
      .def_readonly("source", &Material::source)
      .def_readonly("oiliness", &Material::oiliness)
      .def_readonly("specular_roughness", &Material::specular_roughness)
      .def_property_readonly("band_names",
                             [](const Material& material) {
                               std::vector<std::string> names;
                               for (std::size_t b = 0; b < material.bands.size(); ++b)
                                 names.push_back(band_name(material.bands, b));
                               return names;
                             })
      .def_property_readonly("wavelengths",
                             [](const Material& material) -> py::object {
                               if (material.bands.is_rgb()) return py::none();
                               const std::span<const double> nm = material.bands.wavelengths();
                               return to_array(std::vector<double>(nm.begin(), nm.end()));
                             })
      .def_property_readonly("layer_names", &layer_names)
      .def("text", &format_material)
      .def("layer_stacks", [](const Material& material) {
        return LayerStacks{.stacks = layer_stacks(material),
                           .shape = {static_cast<py::ssize_t>(material.bands.size())}};
      });
  module.def("swatch_scene", [](const Material& material, int side) {
    return swatch_scene(material, side).text();
  });
  module.def("decode_material", &decode_text, py::arg("text"), py::arg("name"),
             py::arg("wavelengths"));
  module.def(
      "find_material",
      [](const std::string& name_or_path, const std::vector<double>& wavelengths) {
        const py::gil_scoped_release unlocked;
        return find_sampled_material(name_or_path, wavelengths, MemoryBudget());
      },
      py::arg("name_or_path"), py::arg("wavelengths"));
  module.def("builtin_material_names", [] {
    std::vector<std::string> names;
    for (const std::string_view name : builtin_material_names()) names.emplace_back(name);
    return names;
  });
  module.def("builtin_material_text", &builtin_material_text, py::arg("name"));
}

}  // namespace lamina::python

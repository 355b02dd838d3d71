// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "recipes.h"

#include <pybind11/stl.h>

#include <algorithm>
#include <cstddef>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "arrays.h"
#include "choices.h"
#include "lamina/base/core/error.h"
#include "lamina/base/core/parallel.h"
#include "lamina/layers/materials/leaf.h"
#include "lamina/layers/materials/skin.h"
#include "lamina/layers/materials/snow.h"
#include "lamina/solve/reflectance/skin_colors.h"
#include "lamina/solve/reflectance/skin_reflectance_table.h"
#include "layer_stacks.h"
#include "natives.h"
#include "work.h"

namespace lamina::python {
namespace {

/// Parameters of many places: arrays by the names that files have, all of one shape. What is not
/// named is as in `start`.
template <class Parameters, class Range>
std::vector<Parameters> parameters_of(const Parameters& start, std::span<const Range> ranges,
                                      const py::dict& arrays, const Shape& shape) {
  std::vector<Parameters> all(size_of(shape), start);
  for (const auto& [key, value] : arrays) {
    const auto name = py::cast<std::string>(key);
    const auto range =
        std::ranges::find_if(ranges, [&](const Range& known) { return known.name == name; });
    if (range == ranges.end()) throw InvalidInput("there is no parameter \"" + name + "\"");
    const auto array = py::cast<Doubles>(value);
    const std::span<const double> numbers = numbers_of(array);
    for (std::size_t i = 0; i < all.size(); ++i) all[i].*(range->value) = numbers[i];
  }
  return all;
}

/// The stacks of all places at all wavelengths: their shape and (wavelengths,).
template <class Parameters, class Make>
LayerStacks stacks_of(const std::vector<Parameters>& places, const Shape& shape,
                      const std::vector<double>& wavelengths, const Make& make) {
  const std::size_t count = wavelengths.size();
  LayerStacks result{.stacks = std::vector<LayerStack>(places.size() * count,
                                                       LayerStack({{.medium = {.ior = 1.0}}})),
                     .shape = with_axis(shape, count)};
  constexpr std::size_t at_once = 64;  // stacks, which take a microsecond each
  const auto make_some = [&](std::size_t part) {
    const std::size_t end = std::min(result.stacks.size(), (part + 1) * at_once);
    for (std::size_t i = part * at_once; i < end; ++i) try {
        result.stacks[i] = make(places[i / count], wavelengths[i % count]);
      } catch (const InvalidInput& error) {
        throw InvalidInput(place_text(i / count, shape) + error.what());
      }
  };
  run_in_parts((result.stacks.size() + at_once - 1) / at_once, make_some);
  return result;
}

template <class Range>
py::list ranges_list(std::span<const Range> ranges) {
  py::list list;
  for (const Range& range : ranges)
    list.append(py::make_tuple(std::string(range.name), range.low, range.high, range.is_length));
  return list;
}

std::vector<SkinParameters> skins_of(const py::dict& arrays, const Shape& shape,
                                     const std::string& constants) {
  return parameters_of(with_constants(SkinParameters{}, choice<SkinConstants>(constants)),
                       skin_parameter_ranges(), arrays, shape);
}

/// A table that holds all of some skins: numbers that they have alike are fixed.
struct SkinTable {
  SkinReflectanceTable table;
  BandWeights weights;
};

/// Reflectances of places, of shape + (wavelengths,).
py::array_t<double> reflectance_of(const SkinTable& t, const py::dict& arrays, const Shape& shape,
                                   const std::string& constants) {
  const std::vector<SkinParameters> skins = skins_of(arrays, shape, constants);
  const std::size_t bands = t.table.wavelengths().size();
  std::vector<double> values(skins.size() * bands);
  {
    constexpr std::size_t at_once = 256;
    run_in_parts((skins.size() + at_once - 1) / at_once, [&](std::size_t part) {
      const std::size_t end = std::min(skins.size(), (part + 1) * at_once);
      for (std::size_t i = part * at_once; i < end; ++i)
        for (std::size_t b = 0; b < bands; ++b)
          values[i * bands + b] = t.table.reflectance_at(b, skins[i]);
    });
  }
  return to_array(std::move(values), with_axis(shape, bands));
}

SkinTable make_skin_table(const std::vector<double>& wavelengths, bool is_diffuse, double theta,
                          const py::dict& fixed, const std::string& constants,
                          const py::object& callback) {
  const SkinParameters skin = skins_of(fixed, Shape{}, constants)[0];
  Work work(callback);
  return work.run([&](const Progress& progress) {
    return SkinTable{
        .table = SkinReflectanceTable(wavelengths, {.is_diffuse = is_diffuse, .theta = theta},
                                      skin_fit_range(skin), progress),
        .weights = make_skin_band_weights(BandSet(wavelengths), skin)};
  });
}

}  // namespace

void bind_recipes(py::module_& module) {
  module.def("skin_parameter_ranges", [] { return ranges_list(skin_parameter_ranges()); });
  module.def("leaf_parameter_ranges", [] { return ranges_list(leaf_parameter_ranges()); });
  module.def("snow_parameter_ranges", [] { return ranges_list(snow_parameter_ranges()); });
  module.def("skin_constants", [](const std::string& constants) {
    const SkinParameters skin = with_constants(SkinParameters{}, choice<SkinConstants>(constants));
    py::dict values;
    for (const SkinParameterRange& range : skin_parameter_ranges())
      values[std::string(range.name).c_str()] = skin.*range.value;
    return values;
  });
  module.def(
      "skin_stacks", [](const py::dict& arrays, const Shape& shape, const std::string& constants,
                        const std::vector<double>& wavelengths) {
        return stacks_of(skins_of(arrays, shape, constants), shape, wavelengths, skin_layer_stack);
      });
  module.def("leaf_stacks", [](const py::dict& arrays, const Shape& shape,
                               const std::vector<double>& wavelengths) {
    return stacks_of(parameters_of(LeafParameters{}, leaf_parameter_ranges(), arrays, shape), shape,
                     wavelengths, leaf_layer_stack);
  });
  module.def("snow_stacks", [](const py::dict& arrays, const Shape& shape,
                               const std::vector<double>& wavelengths) {
    return stacks_of(parameters_of(SnowParameters{}, snow_parameter_ranges(), arrays, shape), shape,
                     wavelengths, snow_layer_stack);
  });
  native_class<SkinTable>(module, "SkinTable")
      .def_static("made", &make_skin_table)
      .def_property_readonly("specular_reflectance",
                             [](const SkinTable& t) { return t.table.specular_reflectance(); })
      .def_property_readonly("color_weights",
                             [](const SkinTable& t) {
                               std::vector<double> weights;
                               for (const auto& band : t.weights)
                                 weights.insert(weights.end(), band.begin(), band.end());
                               const std::size_t bands = t.weights.size();
                               return to_array(std::move(weights),
                                               with_axis(with_axis({}, bands), 3));
                             })
      .def("reflectance", &reflectance_of);
}

}  // namespace lamina::python

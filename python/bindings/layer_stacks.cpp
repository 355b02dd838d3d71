// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "layer_stacks.h"

#include <fmt/core.h>
#include <pybind11/stl.h>

#include <string>
#include <string_view>
#include <utility>
#include <variant>

#include "lamina/base/core/error.h"
#include "natives.h"

namespace lamina::python {
namespace {

/// As pickles hold a lobe: its weight, and g, or None for Rayleigh.
using LobeState = std::pair<double, std::optional<double>>;

void add_lobes(std::vector<LobeState>& lobes, double weight, const HenyeyGreenstein& phase) {
  lobes.emplace_back(weight, phase.g);
}

void add_lobes(std::vector<LobeState>& lobes, double weight, const Rayleigh& /*phase*/) {
  lobes.emplace_back(weight, std::nullopt);
}

void add_lobes(std::vector<LobeState>& lobes, double /*weight*/, const PhaseMixture& mixture) {
  for (const auto& [share, phase] : mixture.lobes)
    std::visit([&, weight = share](const auto& lobe) { add_lobes(lobes, weight, lobe); }, phase);
}

/// None where the phase function is Henyey-Greenstein by the layer's g.
std::optional<std::vector<LobeState>> phase_state(const Layer& layer) {
  if (!layer.phase) return std::nullopt;
  std::vector<LobeState> lobes;
  std::visit([&](const auto& kind) { add_lobes(lobes, 1.0, kind); }, *layer.phase);
  return lobes;
}

std::optional<PhaseFunction> phase_from(const std::optional<std::vector<LobeState>>& state) {
  if (!state) return std::nullopt;
  PhaseMixture mixture;
  for (const auto& [weight, g] : *state) {
    mixture.lobes.push_back({.weight = weight});
    if (g)
      mixture.lobes.back().phase = HenyeyGreenstein{*g};
    else
      mixture.lobes.back().phase = Rayleigh{};
  }
  if (mixture.lobes.size() > 1) return mixture;
  return std::visit([](const auto& phase) { return PhaseFunction(phase); },
                    mixture.lobes.at(0).phase);
}

/// Layers of plain numbers. All arrays have been broadcast: those of layers to shape + (layers,),
/// those of the surroundings to shape.
struct Numbers {
  Doubles sigma_a, sigma_s, g, ior, thickness, roughness;
  std::vector<std::string> phase;         ///< [layer]
  std::vector<std::string> distribution;  ///< [layer], and of the lower boundary
  Doubles ior_above, ior_below, ground_reflectance, ground_roughness;
};

LayerStacks make_layer_stacks(const Numbers& n) {
  LayerStacks result{.stacks = {}, .shape = shape_of(n.ior_above)};
  const std::size_t count = size_of(result.shape);
  const std::size_t layers = n.phase.size();
  const auto distribution = [&](std::size_t layer) {
    return find_enum_value<MicrofacetDistribution>(n.distribution[layer]).value();
  };
  for (std::size_t i = 0; i < count; ++i) {
    std::vector<Layer> stack;
    for (std::size_t l = 0; l < layers; ++l) {
      const std::size_t at = i * layers + l;
      stack.push_back(
          {.medium = {.sigma_a = n.sigma_a.data()[at],
                      .sigma_s = n.sigma_s.data()[at],
                      .g = n.g.data()[at],
                      .ior = n.ior.data()[at]},
           .thickness = n.thickness.data()[at],
           .top = {.roughness = n.roughness.data()[at], .distribution = distribution(l)}});
      if (n.phase[l] == "rayleigh") stack.back().phase = Rayleigh{};
    }
    const Ground ground{
        .top = {.roughness = n.ground_roughness.data()[i], .distribution = distribution(layers)},
        .reflectance = n.ground_reflectance.data()[i]};
    try {
      result.stacks.emplace_back(std::move(stack), n.ior_above.data()[i], n.ior_below.data()[i],
                                 ground);
    } catch (const InvalidInput& error) {
      throw InvalidInput(place_text(i, result.shape) + error.what());
    }
  }
  return result;
}

/// A number of each layer of each stack: shape + (layers,).
template <class Read>
py::array_t<double> of_layers(const LayerStacks& all, const Read& read) {
  std::vector<double> values;
  values.reserve(all.stacks.size() * all.layers());
  for (const LayerStack& stack : all.stacks)
    for (const Layer& layer : stack.layers()) values.push_back(read(layer));
  return to_array(std::move(values), with_axis(all.shape, all.layers()));
}

py::tuple state_of(const LayerStacks& all) {
  py::list stacks;
  for (const LayerStack& stack : all.stacks) {
    py::list layers;
    for (const Layer& layer : stack.layers())
      layers.append(py::make_tuple(layer.medium.sigma_a, layer.medium.sigma_s, layer.medium.g,
                                   layer.medium.ior, layer.thickness, layer.top.roughness,
                                   std::string(name_of(layer.top.distribution)),
                                   phase_state(layer)));
    const Ground& ground = stack.ground();
    stacks.append(py::make_tuple(layers, stack.ior_above(), stack.ior_below(), ground.reflectance,
                                 ground.top.roughness,
                                 std::string(name_of(ground.top.distribution))));
  }
  return py::make_tuple(all.shape, stacks);
}

MicrofacetDistribution distribution_of(const py::handle& name) {
  const auto found = find_enum_value<MicrofacetDistribution>(name.cast<std::string>());
  if (!found) throw InvalidInput("a pickle of layers names no distribution of facets");
  return *found;
}

LayerStacks from_state(const py::tuple& state) {
  if (state.size() != 2) throw InvalidInput("this is no pickle of layers");
  LayerStacks result{.stacks = {}, .shape = state[0].cast<Shape>()};
  for (const py::handle& item : state[1]) {
    const auto stack = item.cast<py::tuple>();
    std::vector<Layer> layers;
    for (const py::handle& of_layer : stack[0]) {
      const auto l = of_layer.cast<py::tuple>();
      layers.push_back(
          {.medium = {l[0].cast<double>(), l[1].cast<double>(), l[2].cast<double>(),
                      l[3].cast<double>()},
           .thickness = l[4].cast<double>(),
           .top = {.roughness = l[5].cast<double>(), .distribution = distribution_of(l[6])},
           .phase = phase_from(l[7].cast<std::optional<std::vector<LobeState>>>())});
    }
    result.stacks.emplace_back(std::move(layers), stack[1].cast<double>(), stack[2].cast<double>(),
                               Ground{.top = {.roughness = stack[4].cast<double>(),
                                              .distribution = distribution_of(stack[5])},
                                      .reflectance = stack[3].cast<double>()});
  }
  if (result.stacks.empty() || result.stacks.size() != size_of(result.shape))
    throw InvalidInput("a pickle of layers must have as many stacks as its shape says");
  return result;
}

}  // namespace

std::string place_text(std::size_t index, const Shape& shape) {
  if (size_of(shape) == 1) return "";
  std::string text;
  for (std::size_t axis = shape.size(); axis-- > 0;) {
    const auto length = static_cast<std::size_t>(shape[axis]);
    text = fmt::format("{}{}{}", index % length, text.empty() ? "" : ", ", text);
    index /= length;
  }
  return "[" + text + "]: ";
}

void bind_layer_stacks(py::module_& module) {
  native_class<LayerStacks>(module, "LayerStacks")
      .def_static(
          "made",
          [](const Doubles& sigma_a, const Doubles& sigma_s, const Doubles& g, const Doubles& ior,
             const Doubles& thickness, const Doubles& roughness,
             const std::vector<std::string>& phase, const std::vector<std::string>& distribution,
             const Doubles& ior_above, const Doubles& ior_below, const Doubles& ground_reflectance,
             const Doubles& ground_roughness) {
            return make_layer_stacks({sigma_a, sigma_s, g, ior, thickness, roughness, phase,
                                      distribution, ior_above, ior_below, ground_reflectance,
                                      ground_roughness});
          })
      .def_property_readonly("shape",
                             [](const LayerStacks& s) { return py::tuple(py::cast(s.shape)); })
      .def_property_readonly("layer_count", &LayerStacks::layers)
      .def_property_readonly("sigma_a",
                             [](const LayerStacks& s) {
                               return of_layers(s, [](const Layer& l) { return l.medium.sigma_a; });
                             })
      .def_property_readonly("sigma_s",
                             [](const LayerStacks& s) {
                               return of_layers(s, [](const Layer& l) { return l.medium.sigma_s; });
                             })
      .def_property_readonly("g",
                             [](const LayerStacks& s) {
                               return of_layers(s, [](const Layer& l) { return l.medium.g; });
                             })
      .def_property_readonly("ior",
                             [](const LayerStacks& s) {
                               return of_layers(s, [](const Layer& l) { return l.medium.ior; });
                             })
      .def_property_readonly("thickness",
                             [](const LayerStacks& s) {
                               return of_layers(s, [](const Layer& l) { return l.thickness; });
                             })
      .def_property_readonly("roughness",
                             [](const LayerStacks& s) {
                               return of_layers(s, [](const Layer& l) { return l.top.roughness; });
                             })
      .def_property_readonly("ior_above",
                             [](const LayerStacks& s) {
                               return read_array(s.stacks, s.shape,
                                                 [](const LayerStack& l) { return l.ior_above(); });
                             })
      .def_property_readonly("ior_below",
                             [](const LayerStacks& s) {
                               return read_array(s.stacks, s.shape,
                                                 [](const LayerStack& l) { return l.ior_below(); });
                             })
      .def_property_readonly("ground_reflectance",
                             [](const LayerStacks& s) {
                               return read_array(s.stacks, s.shape, [](const LayerStack& l) {
                                 return l.ground().reflectance;
                               });
                             })
      .def("flipped",
           [](const LayerStacks& s) {
             LayerStacks turned{.stacks = {}, .shape = s.shape};
             for (const LayerStack& stack : s.stacks) {
               if (is_semi_infinite(stack) || stack.ground().reflectance > 0.0)
                 throw InvalidInput(
                     "flipped: the last layer must be finite and the ground black, but are not");
               turned.stacks.push_back(flipped(stack));
             }
             return turned;
           })
      .def("__getstate__", &state_of)
      .def_static("from_state", &from_state)
      .def("__reduce__", [](const LayerStacks& stacks) {
        // A function of Python's own, which pickles find by its name.
        return py::make_tuple(py::module_::import("lamina._layers").attr("stacks_from_state"),
                              py::make_tuple(state_of(stacks)));
      });
}

}  // namespace lamina::python

// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "half_spaces.h"

#include <cstddef>
#include <string>

#include "arrays.h"
#include "choices.h"
#include "lamina/solve/albedo_inversion/half_space_color.h"
#include "tables.h"

namespace lamina::python {
namespace {

/// Arrays of one shape, and what all of their elements have in common.
struct Looks {
  Doubles ior, g, roughness;
  MicrofacetDistribution distribution;
  ColorDefinition definition;

  [[nodiscard]] HalfSpaceLook at(std::size_t i) const {
    return {ior.data()[i], g.data()[i], {roughness.data()[i], distribution}, definition};
  }
};

Looks looks_of(const Doubles& ior, const Doubles& g, const Doubles& roughness,
               const std::string& distribution, const std::string& definition) {
  return {ior, g, roughness, choice<MicrofacetDistribution>(distribution),
          choice<ColorDefinition>(definition)};
}

/// The half-space of an element. Neighbours are often alike: then it is made once.
const HalfSpaceColor& half_space_at(const Looks& looks, std::size_t i) {
  thread_local HalfSpaceLook last;
  thread_local HalfSpaceColor half_space(last);
  const HalfSpaceLook look = looks.at(i);
  if (look.ior != last.ior || look.g != last.g || look.top != last.top ||
      look.definition != last.definition) {
    half_space = HalfSpaceColor(look);
    last = look;
  }
  return half_space;
}

}  // namespace

void bind_half_spaces(py::module_& module) {
  module.def("color_range", [](const Doubles& ior, const Doubles& g, const Doubles& roughness,
                               const std::string& distribution, const std::string& definition) {
    const Looks looks = looks_of(ior, g, roughness, distribution, definition);
    return table_of(shape_of(ior), 2, [&](std::size_t i, double* out) {
      const HalfSpaceColor& half_space = half_space_at(looks, i);
      out[0] = half_space.darkest();
      out[1] = half_space.brightest();
    });
  });
  module.def("half_space_color", [](const Doubles& albedo, const Doubles& ior, const Doubles& g,
                                    const Doubles& roughness, const std::string& distribution,
                                    const std::string& definition, bool solves) {
    const Looks looks = looks_of(ior, g, roughness, distribution, definition);
    return table_of(shape_of(ior), 1, [&](std::size_t i, double* out) {
      const double a = albedo.data()[i];
      out[0] = solves ? solve_color(looks.at(i), a).color : half_space_at(looks, i).color(a);
    });
  });
  module.def(
      "invert", [](const Doubles& color, const Doubles& radius, const Doubles& ior,
                   const Doubles& g, const Doubles& roughness, const std::string& distribution,
                   const std::string& definition, const std::string& meaning) {
        const Looks looks = looks_of(ior, g, roughness, distribution, definition);
        const auto radius_meaning = choice<RadiusMeaning>(meaning);
        return table_of(shape_of(ior), 3, [&](std::size_t i, double* out) {
          out[0] = half_space_at(looks, i).nearest_albedo(color.data()[i]);
          const Medium medium = medium_of(looks.at(i), out[0], radius.data()[i], radius_meaning);
          out[1] = medium.sigma_a;
          out[2] = medium.sigma_s;
        });
      });
}

}  // namespace lamina::python

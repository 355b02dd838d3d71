// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "map_photons.h"

#include <pybind11/stl.h>

#include <optional>
#include <utility>
#include <vector>

#include "arrays.h"
#include "lamina/base/core/error.h"
#include "lamina/solve/scattering/monte_carlo/cylinder_photons.h"
#include "lamina/solve/scattering/monte_carlo/patch_photons.h"
#include "layer_stacks.h"
#include "work.h"

namespace lamina::python {
namespace {

/// Stacks [row, column] as a patch: they may differ in absorption only.
Patch patch_of(const LayerStacks& stacks, const Shape& shape, const Doubles& irradiance,
               double texel) {
  const LayerStack& first = stacks.stacks.front();
  Patch patch{.stack = first,
              .columns = static_cast<int>(shape[1]),
              .rows = static_cast<int>(shape[0]),
              .texel = texel,
              .sigma_a = std::vector<std::vector<double>>(stacks.layers()),
              .junction = {},
              .irradiance = {irradiance.data(), irradiance.data() + irradiance.size()}};
  for (std::size_t i = 0; i < stacks.stacks.size(); ++i)
    for (std::size_t l = 0; l < stacks.layers(); ++l) {
      const Layer& one = stacks.stacks[i].layers()[l];
      const Layer& like = first.layers()[l];
      if (one.medium.sigma_s != like.medium.sigma_s || one.medium.g != like.medium.g ||
          one.medium.ior != like.medium.ior || one.thickness != like.thickness)
        throw InvalidInput(place_text(i, shape) +
                           "layers must differ in sigma_a only, but differ in other numbers");
      patch.sigma_a[l].push_back(one.medium.sigma_a);
    }
  return patch;
}

/// Values and standard errors, arrays of a shape.
py::tuple estimates(const std::vector<Estimate>& all, const Shape& shape) {
  return py::make_tuple(read_array(all, shape, [](const Estimate& e) { return e.value; }),
                        read_array(all, shape, [](const Estimate& e) { return e.standard_error; }));
}

py::dict patch_photons(const LayerStacks& stacks, const Shape& shape, const Doubles& irradiance,
                       double texel, std::uint64_t photons, std::uint64_t seed, bool is_diffuse,
                       double theta, const py::object& callback) {
  const Patch patch = patch_of(stacks, shape, irradiance, texel);
  Work work(callback);
  const PatchPhotons found = work.run_partly([&](const Progress& progress) {
    return trace_patch_photons(
        patch,
        {.photons = photons, .seed = seed, .incidence = {is_diffuse, theta}, .progress = progress});
  });
  py::dict result;
  result["light"] = estimates(found.exitance, shape);
  result["transmitted"] = estimates(found.transmitted, shape);
  result["photons"] = static_cast<double>(found.photons);
  result["was_interrupted"] = work.was_interrupted();
  return result;
}

py::dict cylinder_photons(const LayerStacks& stacks, const std::vector<py::dict>& cylinders,
                          double width, double length, bool repeats,
                          const std::optional<double>& beam_radius, int columns,
                          std::uint64_t photons, std::uint64_t seed, const py::object& callback) {
  CylinderLayers scene{.stack = stacks.stacks.front(),
                       .cylinders = {},
                       .width = width,
                       .length = length,
                       .sides = repeats ? BoxSides::repeat : BoxSides::open,
                       .beam_radius = beam_radius,
                       .columns = columns};
  for (const py::dict& given : cylinders) {
    Cylinder cylinder;
    const auto read = [&](const char* name, double& value) { value = given[name].cast<double>(); };
    read("x", cylinder.x);
    read("depth", cylinder.depth);
    read("radius", cylinder.radius);
    read("sigma_a", cylinder.sigma_a);
    read("sigma_s", cylinder.sigma_s);
    read("g", cylinder.g);
    scene.cylinders.push_back(cylinder);
  }
  Work work(callback);
  const CylinderPhotons found = work.run_partly([&](const Progress& progress) {
    return trace_cylinder_photons(scene, {.photons = photons, .seed = seed, .progress = progress});
  });
  const auto row = [](const std::vector<Estimate>& all) {
    return estimates(all, Shape{static_cast<py::ssize_t>(all.size())});
  };
  py::dict result;
  result["specular_reflectance"] = found.specular;
  result["diffuse_reflectance"] = row({found.reflected});
  result["transmittance"] = row({found.transmitted});
  result["through_sides"] = row({found.through_sides});
  result["absorptance"] = row(found.absorbed_by_layers);
  result["absorptance_of_cylinders"] = row(found.absorbed_by_cylinders);
  result["reflectance_by_column"] = row(found.reflected_by_column);
  result["photons"] = static_cast<double>(found.photons);
  result["was_interrupted"] = work.was_interrupted();
  return result;
}

}  // namespace

void bind_map_photons(py::module_& module) {
  module.def("patch_photons", &patch_photons);
  module.def("cylinder_photons", &cylinder_photons);
}

}  // namespace lamina::python

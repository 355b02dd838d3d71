// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "surfaces.h"

#include <pybind11/stl.h>

#include <string>
#include <vector>

#include "arrays.h"
#include "choices.h"
#include "heard.h"
#include "lamina/layers/optics/rough/interface_reflectance.h"
#include "lamina/layers/optics/rough/rough_surface_scattering.h"
#include "work.h"

namespace lamina::python {
namespace {

/// Fractions of light that an interface of microfacets reflects and lets through.
py::dict rough_interface(double roughness, double eta, const std::string& distribution,
                         const std::string& masking, const std::vector<double>& cosines) {
  const RoughInterface<double> interface {
    .facets = {.alpha = roughness, .distribution = choice<MicrofacetDistribution>(distribution)},
    .eta = eta
  };
  const FacetMasking hiding = masking == "v_cavity"         ? FacetMasking::v_cavity
                              : masking == "smith_multiple" ? FacetMasking::smith_multiple
                                                            : FacetMasking::smith;
  const InterfaceReflectance table =
      heard([&] { return make_interface_reflectance(interface, hiding); });
  std::vector<double> reflected, transmitted;
  for (const double cosine : cosines) {
    reflected.push_back(reflectance(table, cosine));
    transmitted.push_back(transmittance(table, cosine));
  }
  py::dict result;
  result["reflectance"] = to_array(std::move(reflected));
  result["transmittance"] = to_array(std::move(transmitted));
  result["diffuse_reflectance"] = table.diffuse_reflectance;
  result["diffuse_transmittance"] = table.diffuse_transmittance;
  return result;
}

py::dict scattering_dict(RoughSurfaceScattering found) {
  const Shape shape = {found.cells.thetas, found.cells.phis};
  py::dict result;
  result["brdf"] = to_array(std::move(found.brdf), shape);
  result["btdf"] = to_array(std::move(found.btdf), shape);
  result["brdf_error"] = to_array(std::move(found.brdf_error), shape);
  result["btdf_error"] = to_array(std::move(found.btdf_error), shape);
  result["single_brdf"] = to_array(std::move(found.single_brdf), shape);
  result["single_btdf"] = to_array(std::move(found.single_btdf), shape);
  const auto add = [&](const char* name, const Estimate& estimate) {
    result[name] = py::make_tuple(estimate.value, estimate.standard_error);
  };
  add("reflectance", found.reflectance);
  add("transmittance", found.transmittance);
  add("single_reflectance", found.single_reflectance);
  add("single_transmittance", found.single_transmittance);
  add("start_weight", found.start_weight);
  result["given_up"] = found.given_up;
  return result;
}

py::dict rough_surface(double smoothness, double eta, double theta_i, const std::string& method,
                       std::int64_t rays, std::uint64_t seed, const std::string& visibility,
                       int realizations, const py::object& callback) {
  const GaussianSurface surface{.smoothness = smoothness, .eta = eta};
  Work work(callback);
  return scattering_dict(work.run([&](const Progress& progress) {
    if (method == "monte_carlo")
      return simulate_scattering(surface, theta_i,
                                 {.rays = rays,
                                  .seed = seed,
                                  .visibility = choice<FacetVisibility>(visibility),
                                  .cells = {},
                                  .progress = progress});
    if (method == "height_field")
      return trace_height_fields(surface, theta_i,
                                 {.rays = rays,
                                  .realizations = realizations,
                                  .seed = seed,
                                  .cells = {},
                                  .progress = progress});
    return analytic_scattering(surface, theta_i);
  }));
}

}  // namespace

void bind_surfaces(py::module_& module) {
  module.def("rough_interface", &rough_interface);
  module.def("rough_surface", &rough_surface);
}

}  // namespace lamina::python

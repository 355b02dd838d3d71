// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "bsdf.h"

#include <pybind11/stl.h>

#include <string>
#include <vector>

#include "arrays.h"
#include "lamina/base/core/error.h"
#include "lamina/base/core/parallel.h"
#include "lamina/solve/scattering/layered_bsdf/layered_bsdf.h"
#include "layer_stacks.h"
#include "work.h"

namespace lamina::python {
namespace {

py::dict bsdf(const LayerStacks& stacks, double theta_i, const std::vector<double>& theta_o,
              const std::vector<double>& phi_o, const std::string& method, double accuracy,
              const py::object& callback) {
  Work work(callback);
  const std::vector<StackBsdf> found = work.run([&](const Progress& progress) {
    if (method == "radiative_transfer")
      return stack_bsdf(stacks.stacks, theta_i, theta_o, phi_o,
                        {.accuracy = accuracy, .progress = progress});
    const ScatteringOrders orders =
        method == "first_order" ? ScatteringOrders::first : ScatteringOrders::all;
    std::vector<StackBsdf> all(stacks.stacks.size());
    parallel_for(
        all.size(),
        [&](std::size_t i) {
          try {
            all[i] = layered_bsdf(stacks.stacks[i], orders, theta_i, theta_o, phi_o);
          } catch (const InvalidInput& error) {
            throw InvalidInput(place_text(i, stacks.shape) + error.what());
          }
        },
        progress);
    return all;
  });
  const auto values = [&](std::vector<double> StackBsdf::*of) {
    std::vector<double> all;
    for (const StackBsdf& one : found) all.insert(all.end(), (one.*of).begin(), (one.*of).end());
    return to_array(std::move(all),
                    with_axis(with_axis(stacks.shape, theta_o.size()), phi_o.size()));
  };
  const auto number = [&](double StackBsdf::*of) {
    return read_array(found, stacks.shape, [=](const StackBsdf& one) { return one.*of; });
  };
  py::dict result;
  result["brdf"] = values(&StackBsdf::brdf);
  result["btdf"] = values(&StackBsdf::btdf);
  result["unscattered_reflectance"] = number(&StackBsdf::unscattered_reflectance);
  result["unscattered_transmittance"] = number(&StackBsdf::unscattered_transmittance);
  if (method == "radiative_transfer")
    result["estimated_error"] = number(&StackBsdf::estimated_error);
  return result;
}

}  // namespace

void bind_bsdf(py::module_& module) { module.def("bsdf", &bsdf); }

}  // namespace lamina::python

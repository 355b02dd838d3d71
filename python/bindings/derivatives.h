// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "arrays.h"
#include "lamina/solve/scattering/adding_doubling_derivatives/layer_derivatives.h"

namespace lamina::python {

/// Derivatives by what layers are made of, as arrays of a shape by the names of what they are by.
[[nodiscard]] inline py::dict derivatives_dict(const std::vector<LayerDerivatives>& all,
                                               const Shape& shape) {
  py::dict result;
  const auto add = [&](const char* name, double LayerDerivatives::*by) {
    result[name] = read_array(all, shape, [&](const LayerDerivatives& one) { return one.*by; });
  };
  add("sigma_a", &LayerDerivatives::by_sigma_a);
  add("sigma_s", &LayerDerivatives::by_sigma_s);
  add("g", &LayerDerivatives::by_g);
  add("thickness", &LayerDerivatives::by_thickness);
  return result;
}

}  // namespace lamina::python

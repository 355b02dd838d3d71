// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pybind11/pybind11.h>

#include <cstddef>
#include <string>
#include <vector>

#include "arrays.h"
#include "lamina/layers/optics/layer_stack.h"

namespace lamina::python {

/// Stacks of equally many layers, as an array of any shape: bands, wavelengths, or whatever a user
/// varies.
struct LayerStacks {
  std::vector<LayerStack> stacks;  ///< in C order of the shape
  Shape shape;

  [[nodiscard]] std::size_t layers() const { return stacks[0].layers().size(); }
};

/// "[2, 0]: " of a place in a shape; empty where there is but one stack.
[[nodiscard]] std::string place_text(std::size_t index, const Shape& shape);

void bind_layer_stacks(py::module_& module);

}  // namespace lamina::python

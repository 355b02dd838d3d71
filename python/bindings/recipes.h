// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pybind11/pybind11.h>

namespace lamina::python {

namespace py = pybind11;

/// Skin, leaves and snow of arrays of parameters, and tables of the light that skin reflects.
void bind_recipes(py::module_& module);

}  // namespace lamina::python

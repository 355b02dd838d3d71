// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pybind11/pybind11.h>

namespace lamina::python {

namespace py = pybind11;

/// Maps of skin: made by recipes, from arrays and from files, edited, saved.
void bind_edit(py::module_& module);

}  // namespace lamina::python

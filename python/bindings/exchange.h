// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pybind11/pybind11.h>

namespace lamina::python {

namespace py = pybind11;

/// Materials for other programs.
void bind_exchange(py::module_& module);

}  // namespace lamina::python

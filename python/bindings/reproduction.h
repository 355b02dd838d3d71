// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pybind11/pybind11.h>

namespace lamina::python {

namespace py = pybind11;

/// Tables and figures of papers, made again.
void bind_reproduction(py::module_& module);

}  // namespace lamina::python

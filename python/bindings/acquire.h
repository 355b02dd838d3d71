// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pybind11/pybind11.h>

namespace lamina::python {

namespace py = pybind11;

/// Maps of skin and leaves from photographs, and the choice of bands to photograph in.
void bind_acquire(py::module_& module);

}  // namespace lamina::python

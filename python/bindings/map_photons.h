// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pybind11/pybind11.h>

namespace lamina::python {

namespace py = pybind11;

/// Photons through layers whose absorption varies, and through vessels.
void bind_map_photons(py::module_& module);

}  // namespace lamina::python

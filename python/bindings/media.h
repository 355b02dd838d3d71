// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pybind11/pybind11.h>

namespace lamina::python {

namespace py = pybind11;

/// Phase functions, media by their look, short pulses, integrating spheres.
void bind_media(py::module_& module);

}  // namespace lamina::python

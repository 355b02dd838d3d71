// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pybind11/pybind11.h>

namespace lamina::python {

namespace py = pybind11;

/// lamina's errors as exceptions of Python: Error, and of it InvalidInput, a ValueError, FileError
/// and WriteError, which are OSErrors; and Interrupted, a KeyboardInterrupt.
void bind_errors(py::module_& module);

}  // namespace lamina::python

// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pybind11/pybind11.h>

namespace lamina::python {

namespace py = pybind11;

/// A class whose instances come from the module's functions alone. Python's `__new__` is refused:
/// it would make an instance without a value, and whatever reads that crashes.
template <class T>
[[nodiscard]] py::class_<T> native_class(py::module_& module, const char* name) {
  py::class_<T> made(module, name);
  reinterpret_cast<PyTypeObject*>(made.ptr())->tp_new = [](PyTypeObject* type, PyObject*,
                                                           PyObject*) -> PyObject* {
    PyErr_Format(PyExc_TypeError, "%s: is made by functions of lamina, not by itself",
                 type->tp_name);
    return nullptr;
  };
  return made;
}

}  // namespace lamina::python

// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "errors.h"

#include <exception>
#include <new>

#include "lamina/base/core/error.h"
#include "lamina/base/core/progress.h"

namespace lamina::python {
namespace {

// Live as long as the interpreter, as exceptions of extension modules do.
PyObject *error_type, *invalid_input, *file_error, *write_error, *interrupted;

PyObject* make_exception(py::module_& module, const char* name, const char* doc,
                         const py::tuple& bases) {
  const std::string full = std::string("lamina.") + name;
  PyObject* const type = PyErr_NewExceptionWithDoc(full.c_str(), doc, bases.ptr(), nullptr);
  if (type == nullptr) throw py::error_already_set();
  module.add_object(name, py::reinterpret_borrow<py::object>(type));
  return type;
}

py::tuple both(PyObject* first, PyObject* second) {
  return py::make_tuple(py::reinterpret_borrow<py::object>(first),
                        py::reinterpret_borrow<py::object>(second));
}

}  // namespace

void bind_errors(py::module_& module) {
  error_type = make_exception(module, "Error", "Base of what lamina raises.",
                              py::make_tuple(py::reinterpret_borrow<py::object>(PyExc_Exception)));
  invalid_input = make_exception(
      module, "InvalidInput", "Input that cannot be used: where, what is required, what was given.",
      both(error_type, PyExc_ValueError));
  file_error =
      make_exception(module, "FileError", "A file that cannot be read as what it should be.",
                     both(error_type, PyExc_OSError));
  write_error = make_exception(module, "WriteError", "A file or folder that cannot be written.",
                               both(error_type, PyExc_OSError));
  interrupted = make_exception(
      module, "Interrupted",
      "Ctrl-C, or a progress callback that returned False, ended the work. `result` is what there "
      "was by then, None if nothing.",
      py::make_tuple(py::reinterpret_borrow<py::object>(PyExc_KeyboardInterrupt)));
  if (PyObject_SetAttrString(interrupted, "result", Py_None) != 0) throw py::error_already_set();
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const InvalidInput& error) {
      PyErr_SetString(invalid_input, error.what());
    } catch (const FileError& error) {
      PyErr_SetString(file_error, error.what());
    } catch (const WriteError& error) {
      PyErr_SetString(write_error, error.what());
    } catch (const Interrupted& error) {
      PyErr_SetString(interrupted, error.what());
    } catch (const Error& error) {
      PyErr_SetString(error_type, error.what());
    } catch (const std::bad_alloc&) {
      PyErr_SetString(PyExc_MemoryError, "there is not enough memory");
    }
  });
}

}  // namespace lamina::python

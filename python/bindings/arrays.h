// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <cassert>
#include <cstddef>
#include <memory>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

namespace lamina::python {

namespace py = pybind11;

using Shape = std::vector<py::ssize_t>;

/// Numbers that Python hands over: an array of doubles that lies in one piece is taken as it
/// is, anything else is copied once.
using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;

[[nodiscard]] inline std::size_t size_of(const Shape& shape) {
  return static_cast<std::size_t>(
      std::accumulate(shape.begin(), shape.end(), py::ssize_t{1}, std::multiplies<>()));
}

[[nodiscard]] inline Shape shape_of(const py::array& array) {
  return {array.shape(), array.shape() + array.ndim()};
}

[[nodiscard]] inline Shape with_axis(Shape shape, std::size_t length) {
  shape.push_back(static_cast<py::ssize_t>(length));
  return shape;
}

[[nodiscard]] inline std::span<const double> numbers_of(const Doubles& array) {
  return {array.data(), static_cast<std::size_t>(array.size())};
}

/// A NumPy array that keeps a vector: nothing is copied. Empty where the shape has other elements.
template <class T>
[[nodiscard]] py::array_t<T> to_array(std::vector<T> values, const Shape& shape) {
  assert(values.size() == size_of(shape));
  auto kept = std::make_unique<std::vector<T>>(std::move(values));
  T* const data = kept->data();
  const py::capsule owner(kept.release(),
                          [](void* held) { delete static_cast<std::vector<T>*>(held); });
  return py::array_t<T>(shape, data, owner);
}

template <class T>
[[nodiscard]] py::array_t<T> to_array(std::vector<T> values) {
  const auto size = static_cast<py::ssize_t>(values.size());
  return to_array(std::move(values), Shape{size});
}

/// One number of each of some results, as an array of this shape.
template <class Results, class Read>
[[nodiscard]] py::array_t<double> read_array(const Results& results, const Shape& shape,
                                             const Read& read) {
  std::vector<double> values;
  values.reserve(std::size(results));
  for (const auto& result : results) values.push_back(read(result));
  return to_array(std::move(values), shape);
}

}  // namespace lamina::python

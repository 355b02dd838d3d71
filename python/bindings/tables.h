// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "arrays.h"
#include "lamina/base/core/parallel.h"
#include "work.h"

namespace lamina::python {

/// Results of several columns, of shape + (columns,), one row after the other on all cores.
/// @throws Interrupted after Ctrl-C
template <class Row>
[[nodiscard]] py::array_t<double> table_of(const Shape& shape, std::size_t columns,
                                           const Row& row) {
  const std::size_t rows = size_of(shape);
  Work work(py::none{});
  return to_array(work.run([&](const Progress& progress) {
    std::vector<double> values(rows * columns);
    constexpr std::size_t at_once = 64;
    parallel_for((rows + at_once - 1) / at_once, [&](std::size_t part) {
      for (std::size_t i = part * at_once; i < std::min(rows, (part + 1) * at_once); ++i) {
        row(i, &values[i * columns]);
        report_or_throw(progress, 0.0);
      }
    });
    return values;
  }),
                  with_axis(shape, columns));
}

}  // namespace lamina::python

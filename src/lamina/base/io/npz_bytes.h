// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace lamina {

/// An array of doubles by its name, in row-major order.
struct NpzArray {
  std::string name;                ///< letters, digits and '_'
  std::vector<std::size_t> shape;  ///< its product is the number of values
  std::vector<double> values;
};

/// The bytes of a file that numpy.load reads: a ZIP archive, not compressed, of .npy files of
/// version 1.0. Equal arrays give equal bytes.
///
/// Source: NumPy's NEP 1; PKWARE's APPNOTE 6.3, 4.3.
[[nodiscard]] std::string npz_bytes(std::span<const NpzArray> arrays);

}  // namespace lamina

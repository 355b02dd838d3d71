// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "lamina/solve/scattering/heterogeneous/tables/state_lattice.h"

namespace lamina::detail {

/// Chebyshev points of the box of a lattice, at which what is slow to solve is solved: few give all
/// nodes between them.
class ChebyshevBox {
 public:
  /// @param per_unit  points along an axis for each unit of its length, three more
  /// @param most      along an axis; fewer where all together would be more than 150
  ChebyshevBox(StateLattice lattice, double per_unit, std::size_t most);

  [[nodiscard]] std::size_t size() const;
  [[nodiscard]] LayerState state(std::size_t point) const;

  /// The share of each point in the polynomial at a state, which is brought into the box.
  [[nodiscard]] std::vector<double> shares(const LayerState& state) const;

 private:
  StateLattice lattice_;
  std::vector<std::vector<double>> points_;  ///< [axis] in [-1, 1]
};

}  // namespace lamina::detail

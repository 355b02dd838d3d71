// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <vector>

namespace lamina::detail {

/// Weights of the Gaussians of four operators at a coordinate in [-1, 1]; empty: no operator.
using WeightsOfOperators = std::function<std::array<std::vector<double>, 4>(double)>;

/// The profile of the mean of two coordinates, that of where light comes out, x, and that of where
/// it enters, y, as a sum of products:
///
///     w((x + y) / 2) = sum over terms of exit_term(x) entry_term(y),
///
/// the few that miss least over all operators (singular vectors), and such that it is exact where
/// both ends are alike.
class BothEnds {
 public:
  BothEnds(WeightsOfOperators weights, std::size_t terms);

  [[nodiscard]] std::size_t terms() const { return entry_.size(); }
  [[nodiscard]] double entry(std::size_t term, double y) const;
  /// Weights of the Gaussians of an operator.
  [[nodiscard]] std::vector<double> exit(std::size_t term, std::size_t which, double x) const;

 private:
  WeightsOfOperators weights_;
  std::vector<std::vector<double>> entry_;  ///< [term][node]
};

}  // namespace lamina::detail

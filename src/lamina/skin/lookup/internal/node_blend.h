// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

namespace lamina::lookup_detail {

/// Numbers that nodes of a table of colors have.
inline constexpr std::size_t node_numbers = 16;

struct NodeBlend {
  std::array<float, node_numbers> sums;
  std::array<float, node_numbers> exponentials;  ///< of the sums, to 1e-6 of themselves
};

/// Eight nodes, each times its weight.
/// @param nodes  at each at least `node_numbers` numbers
void blend_nodes(const std::array<const float*, 8>& nodes, const std::array<float, 8>& weights,
                 NodeBlend& blend);

}  // namespace lamina::lookup_detail

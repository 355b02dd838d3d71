// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace lamina::detail {

/// Calls `take(one, other)` with each two texels side by side.
template <class Take>
void for_plane_neighbors(int width, int height, const Take& take) {
  const auto row = static_cast<std::size_t>(width);
  const std::size_t size = row * static_cast<std::size_t>(height);
  for (std::size_t i = 0; i < size; ++i) {
    if ((i + 1) % row != 0) take(i, i + 1);
    if (i + row < size) take(i, i + row);
  }
}

}  // namespace lamina::detail

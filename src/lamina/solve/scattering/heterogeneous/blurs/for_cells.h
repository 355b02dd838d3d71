// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>

#include "lamina/base/core/parallel.h"

namespace lamina::detail {

/// Calls body(i) for each of `count` cells, many at a time on each thread.
template <class Body>
void for_cells(std::size_t count, const Body& body) {
  constexpr std::size_t chunk = 8192;
  parallel_for((count + chunk - 1) / chunk, [&](std::size_t c) {
    for (std::size_t i = c * chunk; i < std::min(count, (c + 1) * chunk); ++i) body(i);
  });
}

}  // namespace lamina::detail

// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

namespace lamina::detail {

/// A number of each texel for each number of skin, or each image: [number][texel].
using TexelMaps = std::vector<std::vector<float>>;

[[nodiscard]] inline double dot(const TexelMaps& a, const TexelMaps& b) {
  double sum = 0.0;
  for (std::size_t n = 0; n < a.size(); ++n)
    for (std::size_t t = 0; t < a[n].size(); ++t)
      sum += static_cast<double>(a[n][t]) * static_cast<double>(b[n][t]);
  return sum;
}

/// a += factor b
inline void add_times(TexelMaps& a, double factor, const TexelMaps& b) {
  const auto f = static_cast<float>(factor);
  for (std::size_t n = 0; n < a.size(); ++n)
    for (std::size_t t = 0; t < a[n].size(); ++t) a[n][t] += f * b[n][t];
}

/// a = factor a + b
inline void scale_and_add(TexelMaps& a, double factor, const TexelMaps& b) {
  const auto f = static_cast<float>(factor);
  for (std::size_t n = 0; n < a.size(); ++n)
    for (std::size_t t = 0; t < a[n].size(); ++t) a[n][t] = f * a[n][t] + b[n][t];
}

}  // namespace lamina::detail

// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "lamina/base/core/vec.h"
#include "lamina/base/image/bilinear.h"

namespace lamina {

/// Texels over texture coordinates, rows from above as in images; they repeat beyond the unit
/// square.
struct TexelGrid {
  int width = 1, height = 1;

  [[nodiscard]] std::size_t count() const {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }
  /// The four texels around a place and their weights, bilinear.
  struct Around {
    std::array<std::size_t, 4> texel{};
    std::array<float, 4> weight{1.0f, 0.0f, 0.0f, 0.0f};

    /// @param values  [texel], or one for all
    template <class Values>
    [[nodiscard]] auto mean(const Values& values) const {
      if (values.size() == 1) return values[0];
      auto sum = weight[0] * values[texel[0]];
      for (std::size_t i = 1; i < 4; ++i) sum += weight[i] * values[texel[i]];
      return sum;
    }
  };
  [[nodiscard]] Around around(Vec2f uv) const {
    if (width == 1 && height == 1) return {};
    const BilinearLookup<float> at =
        bilinear_repeated(uv.x * static_cast<float>(width),
                          (1.0f - uv.y) * static_cast<float>(height), width, height);
    const auto index = [&](int x, int y) {
      return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
             static_cast<std::size_t>(x);
    };
    return {{index(at.x0, at.y0), index(at.x1, at.y0), index(at.x0, at.y1), index(at.x1, at.y1)},
            {(1.0f - at.fx) * (1.0f - at.fy), at.fx * (1.0f - at.fy), (1.0f - at.fx) * at.fy,
             at.fx * at.fy}};
  }
  /// One of the four, at random with its weight.
  [[nodiscard]] std::size_t sample(Vec2f uv, float u) const {
    const Around near = around(uv);
    for (std::size_t i = 0; i < 3; ++i) {
      if (u < near.weight[i]) return near.texel[i];
      u -= near.weight[i];
    }
    return near.texel[3];
  }
};

}  // namespace lamina

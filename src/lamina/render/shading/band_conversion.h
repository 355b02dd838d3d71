// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lamina/base/core/vec.h"
#include "lamina/base/spectrum/band_color.h"
#include "lamina/base/spectrum/band_values.h"

namespace lamina {

/// Between linear Rec.709 colours and the bands of a pass: from_rgb then to_rgb changes nothing.
template <int N>
struct BandConversion {
  float basis[3][N] = {};    ///< what a unit of red, green, blue gives in each band
  float weights[3][N] = {};  ///< what each band adds to red, green, blue

  [[nodiscard]] BandValues<N> from_rgb(const Vec3f& color) const {
    BandValues<N> values;
    for (int b = 0; b < N; ++b)
      values[b] = color.x * basis[0][b] + color.y * basis[1][b] + color.z * basis[2][b];
    return values;
  }
  [[nodiscard]] Vec3f to_rgb(const BandValues<N>& values) const {
    Vec3f color;
    for (int c = 0; c < 3; ++c)
      for (int b = 0; b < N; ++b) color[c] += weights[c][b] * values[b];
    return color;
  }
};

/// For a band set of at most N bands; lanes beyond it stay 0.
///
/// @param weights  [band] of the way to colours, each channel's of sum 1
template <int N>
[[nodiscard]] BandConversion<N> make_band_conversion(const BandSet& bands,
                                                     const BandWeights& weights);

}  // namespace lamina

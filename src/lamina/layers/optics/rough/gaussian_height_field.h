// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "lamina/base/core/random.h"
#include "lamina/base/core/vec.h"

namespace lamina {

/// Shape of a height field, in units of the correlation length tau.
struct HeightFieldShape {
  double smoothness = 3.0;         ///< s = tau / sigma, > 0
  int cells_per_correlation = 16;  ///< 16 flattens the slopes by 0.15 % of their variance
  int correlations_across = 40;    ///< side of the square that repeats
};

/// One realization of a random surface: a periodic square of triangles whose heights are Gaussian
/// with the correlation exp(-r^2 / tau^2).
///
/// White noise is passed through a Gaussian filter, which gives every spatial frequency k the
/// amplitude exp(-k^2 tau^2 / 8) of the wanted spectrum; on the grid the truncation is below 1e-12.
class GaussianHeightField {
 public:
  /// @throws InvalidInput if a value is out of its range.
  GaussianHeightField(const HeightFieldShape& shape, Random& random);

  /// Points on a side; the unit of length, for heights too, is one cell.
  [[nodiscard]] int size() const { return size_; }
  /// Height over the grid point (x, y), which repeats.
  [[nodiscard]] double height(int x, int y) const {
    return heights_[static_cast<std::size_t>(wrap(y)) * static_cast<std::size_t>(size_) +
                    static_cast<std::size_t>(wrap(x))];
  }
  [[nodiscard]] double lowest() const { return lowest_; }
  [[nodiscard]] double highest() const { return highest_; }

 private:
  [[nodiscard]] int wrap(int i) const { return i < 0 ? i + size_ : i >= size_ ? i - size_ : i; }

  int size_;
  double lowest_, highest_;
  std::vector<float> heights_;
};

/// The end of a ray's way through a surface.
struct HeightFieldPath {
  Vec3 wo;        ///< direction in which it leaves; wo.z > 0 above
  int order = 0;  ///< facets met; 0 if it was given up, after 1000 facets or a million cells
};

/// Follows a ray that arrives from wi, wi.z > 0, at a random place of the field, until it leaves;
/// at each facet it is reflected or refracted as Fresnel's law has it.
///
/// @param eta  refractive index below the field over that above, > 0.
[[nodiscard]] HeightFieldPath trace_path(const GaussianHeightField& field, double eta,
                                         const Vec3& wi, Random& random);

}  // namespace lamina

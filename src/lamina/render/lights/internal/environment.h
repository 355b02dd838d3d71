// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include "lamina/base/core/vec.h"
#include "lamina/base/image/image.h"
#include "lamina/render/lights/internal/segment_search.h"

namespace lamina {

[[nodiscard]] inline float mean_of_channels(const Vec3f& color) {
  return (color.x + color.y + color.z) / 3.0f;
}

/// Light from far away in every direction: a latitude-longitude map, bilinear between its pixels.
///
/// The top of the map is +y and its middle is -z, with +x to the right of it. Directions are drawn
/// with a density that is bilinear too: it follows the brightness above the mean of the map, so a
/// sun is never met by chance, and the even rest is left to the sampling of surfaces.
///
/// Source: [Karlik2019] for subtracting the mean where samples are combined.
class Environment {
 public:
  /// A constant sky. Directions cannot be drawn: its density is 0.
  explicit Environment(const Vec3f& radiance);

  /// @param image     of three colour channels, or one; negative values and NaN count as 0.
  /// @param scale     factor per channel
  /// @param rotation  about +y [rad]
  Environment(const Image& image, const Vec3f& scale, float rotation);

  struct Seen {
    Vec3f radiance;
    float pdf;  ///< of drawing that direction [1/sr]
  };
  [[nodiscard]] Seen evaluate(const Vec3f& direction) const;

  struct Sample {
    Vec3f direction;
    Seen seen;
  };
  /// A direction for u in the unit square. Only if can_be_sampled().
  [[nodiscard]] Sample sample(Vec2f u) const;

  [[nodiscard]] bool can_be_sampled() const { return total_ > 0.0; }

  /// Mean over the sphere of the radiance, and of the part of it that directions are drawn from.
  [[nodiscard]] Vec3f mean_radiance() const { return mean_; }
  [[nodiscard]] float mean_sampled() const;
  /// In any direction, mean of the channels.
  [[nodiscard]] float greatest_brightness() const { return greatest_brightness_; }

 private:
  struct Texel {
    Vec3f radiance;
    float weight;  ///< what directions are drawn from
  };
  // Cells lie between the centres of pixels, so each has four corners; the first and the last row
  // are half as high and end at the poles.
  [[nodiscard]] const Texel& corner(int column, int row) const;
  [[nodiscard]] Texel interpolate(int column, int row, float fx, float fy) const;
  [[nodiscard]] float density(const Texel& texel, int row, float sin_theta) const;

  [[nodiscard]] std::span<const float> ends_of_row(int row) const;

  int width_ = 1, height_ = 1;
  float cos_rotation_ = 1.0f, sin_rotation_ = 0.0f;
  std::vector<Texel> texels_;       ///< [y][x]
  std::vector<float> row_ends_;     ///< cumulative weight of the rows of cells
  std::vector<float> column_ends_;  ///< [row][column], cumulative within a row, ends at 1
  std::vector<SegmentSearch> row_search_, column_search_;  ///< one; [row]
  std::vector<float> row_scale_;  ///< (cos theta_0 - cos theta_1) / (theta_1 - theta_0)
  double total_ = 0.0;            ///< integral of the weight over the sphere
  Vec3f mean_;
  float greatest_brightness_ = 0.0f;
};

}  // namespace lamina

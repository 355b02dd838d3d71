// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "lamina/base/core/low_discrepancy.h"
#include "lamina/base/core/vec.h"
#include "lamina/scene/description/scene.h"
#include "lamina/scene/surface/ray.h"

namespace lamina {

/// Rays of a perspective camera with a thin lens, one pixel at a time.
///
/// The pixel filter is Blackman and Harris' window of a radius of 1.5 pixels: positions are drawn
/// from it, so all samples count the same and no pixel needs its neighbours' samples.
class CameraRays {
 public:
  /// @throws InvalidInput if the camera looks nowhere: position and target equal, up along the
  /// view.
  CameraRays(const Camera& camera, int width, int height);

  [[nodiscard]] Ray make_ray(int x, int y, PixelSamples& samples) const;

  /// Angle between the rays of neighbouring pixels in the middle of the image [rad].
  [[nodiscard]] float pixel_angle() const { return static_cast<float>(pixel_size_); }

 private:
  [[nodiscard]] float sample_offset(float u) const;

  Vec3 position_;
  Frame frame_;        ///< x right, y up, z backward
  double pixel_size_;  ///< in the image plane at distance 1
  double width_, height_;
  double lens_radius_, focus_distance_;  ///< [mm]
  std::vector<float> filter_quantiles_;  ///< [pixel]
};

}  // namespace lamina

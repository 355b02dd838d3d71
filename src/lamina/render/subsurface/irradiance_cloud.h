// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "lamina/base/core/vec.h"

namespace lamina {

/// A sample of the light that enters a translucent surface, standing for a patch of it.
struct CloudPoint {
  Vec3f position;  ///< mean of the patch [mm]
  Vec3f normal;    ///< unit length
  Vec2f uv;
  float area = 0.0f;       ///< of the patch [mm²]
  Vec3f albedo{1, 1, 1};   ///< mean of the material's colour over the patch, linear Rec.709
  float thickness = 0.0f;  ///< of the object below the patch [mm]; infinite where it is thick
};

/// The light on all of the surface of one material: what does not depend on the camera.
struct IrradianceCloud {
  std::uint32_t material = 0;
  std::size_t bands = 0;
  float spacing = 0.0f;  ///< square root of the mean area of a patch [mm]
  std::vector<CloudPoint> points;
  std::size_t wide_from =
      std::numeric_limits<std::size_t>::max();  ///< points from there on are
                                                ///< further apart: none sees them
  /// [point][band], flux per area that has passed the boundary, mean over the patch; empty once it
  /// has spread
  std::vector<float> irradiance;
  /// [point][band], of light that has spread: flux per area that leaves, and the share that would
  /// if all of the surface were like the patch. Empty before.
  std::vector<float> exitance, reflectance;
  /// Transmittances of light that entered on the other side of a sheet. Such points come twice,
  /// those below behind all those above. Empty where the material is on no sheet.
  std::vector<float> transmittance;
};

/// How the light that leaves a material differs from that of a planar method, all over its surface:
/// what CorrectedTransport keeps.
struct LightRatioCloud {
  static constexpr std::size_t shape_terms = 3, direction_terms = 5;
  struct Place {
    Vec3f position;        ///< [mm]
    Vec3f normal;          ///< unit length
    float added_exitance;  ///< by which the planar light counts as more there, >= 0
  };

  std::uint32_t material = 0;
  std::size_t bands = 0;
  std::size_t walks = 0;    ///< that found it
  double change = 0.0;      ///< as LightCorrection
  double error_left = 0.0;  ///< the same
  float spacing = 0.0f;     ///< of places [mm]
  std::vector<Place> places;
  std::vector<float> shape;   ///< [term][band], of all of the surface
  std::vector<float> ratios;  ///< [place][term][band]
};

}  // namespace lamina

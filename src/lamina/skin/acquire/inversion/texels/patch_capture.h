// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "lamina/solve/scattering/heterogeneous/blurs/gaussian_blurs.h"

namespace lamina {

inline constexpr double least_relative_deviation = 1e-4;

/// A photograph of a patch of skin through one filter.
struct PatchImage {
  Plane reflected;  ///< what leaves, in the unit of its light; without what the surface mirrors
  /// Standard deviation of each texel, > 0; infinite: the texel is not known. Less than
  /// `least_relative_deviation` of its light counts as that
  Plane deviation;
  /// Weights of the light in the image, [wavelength]: filter times lamp times sensor, of sum 1.
  std::vector<double> sensor;
  std::size_t light = 0;  ///< which pattern lights it
};

/// Photographs of one patch, texel upon texel: of narrow bands or wide ones, of red, green and
/// blue, under one light or several patterns. Beyond its edges the patch goes on as its mirror
/// image.
struct PatchCapture {
  int width = 0, height = 0;  ///< texels of all planes
  double mm_per_texel = 0.1;
  double theta = 0.0;               ///< angle of incidence [rad], in [0, pi/2)
  std::vector<double> wavelengths;  ///< [nm], ascending
  std::vector<Plane> lights;        ///< irradiance that arrives, >= 0
  std::vector<PatchImage> images;
};

/// Texels from (x, y) on.
struct TexelRectangle {
  int x = 0, y = 0, width = 0, height = 0;
};

/// @throws InvalidInput naming image, texel, the rule that is broken and the value given: planes of
///         other sizes, numbers that are not finite where texels are known, reflected light far
///         below 0, weights that do not sum to 1, no texel that is lit and known.
void check_capture(const PatchCapture& capture);

/// Checks a part of a larger capture, which may have no texel that is lit and known.
///
/// @param left,top  where the part lies in the larger one, for messages
/// @return          how many texels of all images are lit and known
std::size_t check_part(const PatchCapture& part, int left, int top);

}  // namespace lamina

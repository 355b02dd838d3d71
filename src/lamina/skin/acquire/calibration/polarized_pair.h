// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>

#include "lamina/skin/acquire/calibration/develop.h"

namespace lamina {

struct PolarizedPairOptions {
  /// The share of mirrored light that crossed polarizers still let through, in [0, .5): one over
  /// their extinction ratio.
  double leak = 0.0;
  /// Beyond this specular reflectance in any channel a pixel is marked `specular`, since what is
  /// left of its diffuse light is uncertain; infinite: none.
  double most_specular = std::numeric_limits<double>::infinity();
};

struct PolarizedPair {
  Developed diffuse;         ///< light that came back from below the surface
  Image specular;            ///< light that the surface mirrors; also below 0, by noise
  Image specular_deviation;  ///< its standard deviation
};

/// Separates light by its polarization: light that the surface mirrors keeps its polarization, that
/// from below has lost it, and half of it passes either way. With a leak l, and both photographs
/// relative to all the light that a white reference returns,
///
///   crossed = diffuse / 2 + l specular,    parallel = diffuse / 2 + (1 - l) specular.
///
/// Where the white reference was photographed through the same polarizers, half of its light is
/// lost as well: develop both with half of its reflectance.
///
/// Holds for skin, whose light from below is polarized by less than some 5 %, more where little is
/// scattered: at the edge of a thin light, and in dark skin in blue.
/// @throws InvalidInput for images of different sizes or channels, or a leak out of range; if no
///         pixel is left.
///
/// Source: [Jacques2002]; [Ma2007] §3.
[[nodiscard]] PolarizedPair separate_polarized(const Developed& parallel, const Developed& crossed,
                                               const PolarizedPairOptions& options = {});

}  // namespace lamina

// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <span>
#include <string_view>

#include "lamina/layers/optics/layer_stack.h"

namespace lamina {

/// Parameters of snow. The values are those of clean, settled snow.
struct SnowParameters {
  double grain_radius = 0.1;  ///< of spheres with as much surface per volume [mm]
  double density = 200.0;     ///< [kg/m³]
  double soot = 0.0;          ///< black carbon, millionths of the mass
  double dust = 0.0;          ///< mineral dust, millionths of the mass
  double thickness = std::numeric_limits<double>::infinity();  ///< [mm]
};

/// A number of SnowParameters and the closed range that it must lie in.
struct SnowParameterRange {
  std::string_view name;  ///< as in files
  double SnowParameters::*value;
  double low, high;
  bool is_length = false;  ///< in mm
};

/// All numbers of SnowParameters; an infinite thickness is in range, too.
[[nodiscard]] std::span<const SnowParameterRange> snow_parameter_ranges();

/// Imaginary part of the refractive index of ice at a wavelength [nm] in [380, 1000]. Below 400 nm
/// it is an upper limit. Source: [WarrenBrandt2008].
[[nodiscard]] double ice_absorption_index(double wavelength);

/// Snow at a wavelength [nm] in [380, 1000]: grains of ice in air, without a boundary.
///
/// Ice takes a share f = density / 917 of the volume. Grains much larger than the wavelength, of
/// any convex shape in all orientations, have extinction 1.5 f / grain_radius, half of it
/// diffraction, and absorption B f 4 pi k / wavelength, where B is the lengthening of paths by
/// reflections within grains [KokhanovskyZege2004]. Shape enters by two numbers: B = 1.6
/// [Libois2014], and the mean cosine .82, the middle of what 33 samples of snow have
/// [Robledano2023]. Spheres have 1.25 and .89. Soot and dust lie between grains and add the
/// coefficients of their spheres by Mie.
///
/// Holds where a grain absorbs little of the light that enters it, as everywhere in this range of
/// wavelengths, and for grains that scatter as if alone. The phase function is Henyey-Greenstein.
/// @throws InvalidInput naming the parameter, its range and the value given.
[[nodiscard]] LayerStack snow_layer_stack(const SnowParameters& snow, double wavelength);

}  // namespace lamina

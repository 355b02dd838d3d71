// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <string_view>

#include "lamina/layers/optics/layer_stack.h"

namespace lamina {

/// Contents of a leaf per area, in the units of [Feret2017], and how it scatters. The values are
/// those of a green oak leaf.
struct LeafParameters {
  double chlorophyll = 40.0;     ///< a and b [µg/cm²]
  double carotenoids = 6.0;      ///< [µg/cm²]
  double anthocyanins = 5.0;     ///< [µg/cm²]
  double brown_pigments = 0.03;  ///< of dying leaves; no unit
  double water = 0.012;          ///< equivalent thickness [cm]
  double dry_matter = 0.003;     ///< [g/cm²]
  double structure = 1.6;        ///< reduced scattering optical thickness of the whole leaf
  double palisade_share = 0.7;   ///< of what absorbs; the rest is in the spongy layer
  double thickness = 0.2;        ///< [mm]
};

/// A number of LeafParameters and the closed range that it must lie in.
struct LeafParameterRange {
  std::string_view name;  ///< as in files
  double LeafParameters::*value;
  double low, high;
  bool is_length = false;  ///< in mm
};

/// All numbers of LeafParameters.
[[nodiscard]] std::span<const LeafParameterRange> leaf_parameter_ranges();

/// Wavelengths of the recipe [nm].
inline constexpr double shortest_leaf_wavelength = 400.0, longest_leaf_wavelength = 1000.0;

/// Absorption optical thickness of all that a leaf holds, at a wavelength of the recipe.
/// Source: specific absorption coefficients of [Feret2017].
[[nodiscard]] double leaf_absorption(const LeafParameters& leaf, double wavelength);

/// Absorption of a unit of all that a leaf holds, for use at many places.
struct LeafSpectrum {
  double chlorophyll, carotenoids, anthocyanins, brown_pigments, water, dry_matter;
};
[[nodiscard]] LeafSpectrum leaf_spectrum(double wavelength);
[[nodiscard]] double leaf_absorption(const LeafParameters& leaf, const LeafSpectrum& spectrum);

/// The layers of leaf_layer_stack, of a leaf in range.
[[nodiscard]] std::array<Layer, 2> leaf_layers(const LeafParameters& leaf,
                                               const LeafSpectrum& spectrum);

/// Palisade cells over spongy cells, as thick as each other, between air. Smooth, index 1.4.
///
/// The scattering is lamina's: the same at all wavelengths, as by cells with air between them, 30 %
/// of it in the palisade layer (a share that fits the ten leaves of [Noda2013] well), mean cosine
/// 0.8. Pigments are spread evenly in each layer, not in grains, so pigment amounts from a fit are
/// somewhat below those of chemistry. With amounts fitted, reflectance and transmittance from both
/// sides are met within 0.010-0.018 RMS over 400-800 nm; with water fitted, too, those of the upper
/// side within 0.006-0.016 over 400-1000 nm. Water is linear between 5 nm: up to 6 % of it off at
/// 948 nm, 2e-4 of optical thickness in a green leaf.
/// @throws InvalidInput naming the parameter, its range and the value given.
[[nodiscard]] LayerStack leaf_layer_stack(const LeafParameters& leaf, double wavelength);

}  // namespace lamina

// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/layers/materials/leaf.h"

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"
#include "lamina/layers/materials/leaf_tables.h"

namespace lamina {
namespace {

constexpr double ior = 1.4, g = 0.8, palisade_scattering = 0.3;  // see leaf_layer_stack

constexpr LeafParameterRange leaf_ranges[] = {
    {"chlorophyll", &LeafParameters::chlorophyll, 0.0, 200.0},
    {"carotenoids", &LeafParameters::carotenoids, 0.0, 60.0},
    {"anthocyanins", &LeafParameters::anthocyanins, 0.0, 60.0},
    {"brown_pigments", &LeafParameters::brown_pigments, 0.0, 5.0},
    {"water", &LeafParameters::water, 0.0, 0.2},
    {"dry_matter", &LeafParameters::dry_matter, 0.0, 0.05},
    {"structure", &LeafParameters::structure, 0.1, 50.0},
    {"palisade_share", &LeafParameters::palisade_share, 0.0, 1.0},
    {"thickness", &LeafParameters::thickness, 0.01, 10.0, true},
};

void check(const LeafParameters& leaf) {
  for (const LeafParameterRange& range : leaf_ranges) {
    const double value = leaf.*range.value;
    if (value >= range.low && value <= range.high) continue;
    PlainTextStream message;
    message << "leaf: " << range.name << " must lie in [" << range.low << ", " << range.high
            << "], but is " << value;
    throw InvalidInput(message.str());
  }
}

}  // namespace

std::span<const LeafParameterRange> leaf_parameter_ranges() { return leaf_ranges; }

LeafSpectrum leaf_spectrum(double wavelength) {
  return {.chlorophyll = interpolate(chlorophyll_absorption, wavelength),
          .carotenoids = interpolate(carotenoid_absorption, wavelength),
          .anthocyanins = interpolate(anthocyanin_absorption, wavelength),
          .brown_pigments = interpolate(brown_absorption, wavelength),
          .water = interpolate(leaf_water_absorption, wavelength),
          .dry_matter = interpolate(dry_matter_absorption, wavelength)};
}

double leaf_absorption(const LeafParameters& leaf, const LeafSpectrum& spectrum) {
  return leaf.chlorophyll * spectrum.chlorophyll + leaf.carotenoids * spectrum.carotenoids +
         leaf.anthocyanins * spectrum.anthocyanins + leaf.brown_pigments * spectrum.brown_pigments +
         leaf.water * spectrum.water + leaf.dry_matter * spectrum.dry_matter;
}

double leaf_absorption(const LeafParameters& leaf, double wavelength) {
  return leaf_absorption(leaf, leaf_spectrum(wavelength));
}

std::array<Layer, 2> leaf_layers(const LeafParameters& leaf, const LeafSpectrum& spectrum) {
  const double absorption = leaf_absorption(leaf, spectrum), d = 0.5 * leaf.thickness;
  const auto layer = [&](double absorption_share, double scattering_share) -> Layer {
    return {.medium = {.sigma_a = absorption_share * absorption / d,
                       .sigma_s = scattering_share * leaf.structure / (d * (1.0 - g)),
                       .g = g,
                       .ior = ior},
            .thickness = d};
  };
  return {layer(leaf.palisade_share, palisade_scattering),
          layer(1.0 - leaf.palisade_share, 1.0 - palisade_scattering)};
}

LayerStack leaf_layer_stack(const LeafParameters& leaf, double wavelength) {
  check(leaf);
  const std::array<Layer, 2> layers = leaf_layers(leaf, leaf_spectrum(wavelength));
  return LayerStack({layers.begin(), layers.end()});
}

}  // namespace lamina

// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "lamina/base/spectrum/band_color.h"
#include "lamina/scene/description/scene.h"

namespace lamina {

/// The bands of a scene: of its first translucent material in use by wavelengths, else of the first
/// one, else RGB.
[[nodiscard]] BandSet bands_of(const Scene& scene);

/// Layers of a scene that light is followed through.
struct SceneLayers {
  const SurfaceMaterial* surface = nullptr;  ///< that they belong to
  const Material* material = nullptr;
};

/// Layers of all translucent surfaces in use, then those that lie over surfaces.
[[nodiscard]] std::vector<SceneLayers> layers_of(const Scene& scene);

/// Weights that turn the bands into colors. Where all that is translucent is skin, or was given in
/// RGB and so has the spectra that show its colors, those that know the spectra of skin, as `lamina
/// patch` uses: others would make it too dark by up to 5 % in green.
[[nodiscard]] BandWeights weights_of_bands(const Scene& scene, const BandSet& bands);

/// Turns all translucent materials in use into those of the bands of the scene, and says so in its
/// `band_changes`.
///
/// Coefficients in RGB become smooth over wavelength: between those of red, green and blue, by the
/// weights with which the three make up the spectrum of a color. Then the absorption of each band
/// is such that thick layers reflect the smooth spectrum of the color that they have in RGB, by
/// adding-doubling. So that color stays, exactly where absorption can give it; those of thin parts
/// and by other solvers nearly. Skin is made anew for other wavelengths, other coefficients are
/// interpolated, and constant beyond those given.
void make_bands_common(Scene& scene);

/// Describes the change of a material in a line.
[[nodiscard]] std::string describe_band_change(const BandChange& change, const Scene& scene);

}  // namespace lamina

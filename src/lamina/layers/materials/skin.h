// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "lamina/base/core/enum_names.h"
#include "lamina/layers/optics/layer_stack.h"

namespace lamina {

// Absorption coefficients of pure substances [1/mm] at a wavelength [nm] in [350, 1000].

/// Eumelanin: the inside of a melanosome, 6.6e10 nm^-3.33 [Jacques1998], as in [Donner2008].
/// At 500 nm that is 67.9/mm, 31 % more than the 51.9/mm of [Jacques2013]: a melanin fraction means
/// nothing without the name of its curve.
[[nodiscard]] double eumelanin_absorption(double wavelength);

/// Pheomelanin, 2.9e14 nm^-4.75, as in [Donner2008].
[[nodiscard]] double pheomelanin_absorption(double wavelength);

/// Skin without blood and pigment, 0.0244 + 8.53 exp(-(nm - 154) / 66.2). Source: [Jacques1998],
/// rat.
[[nodiscard]] double baseline_absorption(double wavelength);

/// Whole blood of 150 g/L hemoglobin, all of it with or without oxygen.
/// Source: [Prahl1998], natural units: ln 10 times the decadic extinction.
[[nodiscard]] double oxyhemoglobin_absorption(double wavelength);
[[nodiscard]] double deoxyhemoglobin_absorption(double wavelength);

/// A solution of 1 g/L beta-carotene. [Donner2008] gives its fraction no unit; this is ours.
[[nodiscard]] double carotene_absorption(double wavelength);

/// Microfacet alpha of the surface of skin as lamps are mirrored in it: one lobe of a face is about
/// .3 wide [DEonLuebke2007], after the measurements of [Weyrich2006].
inline constexpr double skin_specular_roughness = 0.32;

/// Ink in the sheet between epidermis and dermis.
struct SkinInk {
  std::string name = {};
  double absorbance = 0.0;  ///< natural, of diffuse light per crossing, in [0, largest_absorbance]
  /// Factors on it, as SkinParameters::junction_spectrum
  std::vector<std::array<double, 2>> spectrum = {};
};
inline constexpr double largest_absorbance = 10.0;

/// Parameters of skin at one place; fractions are of volume. Source: [Donner2008] Table 1 and
/// eqs. 10-12, and three scales that measured skin asks for. The ranges are those of
/// skin_parameter_ranges.
struct SkinParameters {
  double melanin = 0.02;                ///< of the epidermis
  double melanin_blend = 0.6;           ///< share of eumelanin
  double hemoglobin_epidermis = 0.002;  ///< whole blood in the epidermis
  double hemoglobin_dermis = 0.01;      ///< whole blood in the dermis
  double carotene = 0.001;              ///< 1 g/L solution in the epidermis
  double saturation_epidermis = 0.624;  ///< oxygenated share of that blood
  double saturation_dermis = 0.624;
  double baseline_scale = 0.084;        ///< times baseline_absorption
  double scattering_scale = 0.568;      ///< times the scattering of eq. 12
  double scattering_power = 0.0;        ///< further factor (nm / 550)^power
  double epidermis_thickness = 0.25;    ///< [mm]
  double junction_absorption = 0.0175;  ///< of the sheet between the layers: natural, per crossing
  double dermis_thickness = std::numeric_limits<double>::infinity();  ///< [mm]; finite in an ear
  /// Factor on junction_absorption, in [0, 1], at ascending wavelengths [nm]: linear between them,
  /// constant beyond. Empty: 1, as of black ink.
  std::vector<std::array<double, 2>> junction_spectrum;
  std::vector<SkinInk> inks;  ///< further ones in the same sheet, each of its color
};

/// A number of SkinParameters and the closed range that it must lie in.
struct SkinParameterRange {
  std::string_view name;  ///< as in files
  double SkinParameters::*value;
  double low, high;
  bool is_length = false;  ///< in mm
};

/// All numbers of SkinParameters. An infinite dermis_thickness is valid, too.
[[nodiscard]] std::span<const SkinParameterRange> skin_parameter_ranges();

/// The constants that no map gives: saturations, baseline and scattering. They belong to the solver
/// that they were fitted with (tools/fit/skin_constants.cpp).
enum class SkinConstants {
  paper,                 ///< as printed in [Donner2008]; saturations .75, which it does not print
  calibrated,            ///< fitted to 100 forearms [Cooksey2017] with exact totals
  calibrated_diffusion,  ///< the same with the closed form of the multipole
};

template <>
inline constexpr auto enum_names<SkinConstants> = std::to_array<EnumName<SkinConstants>>(
    {{"paper", SkinConstants::paper},
     {"calibrated", SkinConstants::calibrated},
     {"calibrated_diffusion", SkinConstants::calibrated_diffusion}});

/// Recipe of skin, the same everywhere.
struct SkinRecipe {
  SkinParameters skin;
  SkinConstants constants = SkinConstants::calibrated;
};

/// Whether constants were fitted with totals of radiative transfer.
[[nodiscard]] constexpr bool are_for_transfer_totals(SkinConstants constants) {
  return constants == SkinConstants::calibrated;
}

/// The parameters with their constants replaced by those of a set.
[[nodiscard]] SkinParameters with_constants(SkinParameters parameters, SkinConstants constants);

/// Absorption of all that skin is made of at one wavelength [1/mm], for use at many places.
struct SkinSpectrum {
  double eumelanin, pheomelanin, oxyhemoglobin, deoxyhemoglobin, carotene, baseline;
};
[[nodiscard]] SkinSpectrum skin_spectrum(double wavelength);
[[nodiscard]] double epidermis_absorption(const SkinParameters& skin, const SkinSpectrum& spectrum);
[[nodiscard]] double dermis_absorption(const SkinParameters& skin, const SkinSpectrum& spectrum);

/// Factor of a spectrum of points at a wavelength [nm]: 1 if it has none.
[[nodiscard]] double spectrum_factor(std::span<const std::array<double, 2>> points,
                                     double wavelength);

/// Absorbance of the sheet between the layers at a wavelength [nm], inks included: natural
/// absorbance of diffuse light per crossing.
[[nodiscard]] double junction_absorbance(const SkinParameters& skin, double wavelength);

/// Absorption of the epidermis and of the dermis [1/mm]. Source: [Donner2008] eqs. 10, 11.
[[nodiscard]] double epidermis_absorption(const SkinParameters& skin, double wavelength);
[[nodiscard]] double dermis_absorption(const SkinParameters& skin, double wavelength);

/// Reduced scattering of the epidermis [1/mm]; the dermis has half of it. Source: [Donner2008]
/// eq. 12.
[[nodiscard]] double epidermis_scattering(const SkinParameters& skin, double wavelength);

/// Mean cosine of scattering in skin, 0.62 + 0.29e-3 nm. Source: [VanGemert1989].
[[nodiscard]] double skin_mean_cosine(double wavelength);

/// Epidermis over dermis, indices 1.4 and 1.38, at one wavelength: a half-space, or with a finite
/// dermis a fold of skin as in an ear, whose far side is an epidermis, too.
///
/// The absorbing junction is the last 1 µm of the epidermis, the basal cells. Its optical thickness
/// of absorption is half of junction_absorbance, because diffuse light
/// crosses a thin sheet on a path of twice its thickness. (Diffusion passes straight through so
/// thin a layer and sees this half only: 0.9 % of the light per crossing by default.)
/// @throws InvalidInput naming the parameter, its range and the value given.
[[nodiscard]] LayerStack skin_layer_stack(const SkinParameters& skin, double wavelength);

/// Names of the layers of skin_layer_stack.
[[nodiscard]] std::vector<std::string> skin_layer_names(const SkinParameters& skin);

}  // namespace lamina

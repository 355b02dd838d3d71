// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/layers/materials/skin.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"
#include "lamina/layers/materials/chromophore_tables.h"

namespace lamina {
namespace {

constexpr double ior_epidermis = 1.40, ior_dermis = 1.38;
constexpr double junction_thickness = 1e-3;  // [mm]

/// Natural absorption [1/mm] of a solution of `grams_per_litre` from its decadic molar extinction.
double absorption(double extinction, double grams_per_litre, double grams_per_mole) {
  constexpr double mm_per_cm = 10.0;
  return std::numbers::ln10 * extinction * grams_per_litre / grams_per_mole / mm_per_cm;
}

double blood_absorption(double saturation, const SkinSpectrum& spectrum) {
  return saturation * spectrum.oxyhemoglobin + (1.0 - saturation) * spectrum.deoxyhemoglobin;
}

constexpr SkinParameterRange skin_ranges[] = {
    {"melanin", &SkinParameters::melanin, 0.0, 0.5},
    {"melanin_blend", &SkinParameters::melanin_blend, 0.0, 1.0},
    {"hemoglobin_epidermis", &SkinParameters::hemoglobin_epidermis, 0.0, 0.05},
    {"hemoglobin_dermis", &SkinParameters::hemoglobin_dermis, 0.0, 0.1},
    {"carotene", &SkinParameters::carotene, 0.0, 0.05},
    {"saturation_epidermis", &SkinParameters::saturation_epidermis, 0.0, 1.0},
    {"saturation_dermis", &SkinParameters::saturation_dermis, 0.0, 1.0},
    {"baseline_scale", &SkinParameters::baseline_scale, 0.0, 5.0},
    {"scattering_scale", &SkinParameters::scattering_scale, 0.1, 3.0},
    {"scattering_power", &SkinParameters::scattering_power, -2.0, 2.0},
    {"epidermis_thickness", &SkinParameters::epidermis_thickness, 0.01, 10.0, true},
    {"junction_absorption", &SkinParameters::junction_absorption, 0.0, 10.0},
    {"dermis_thickness", &SkinParameters::dermis_thickness, 0.01, 100.0, true},
};

void check(const SkinParameters& skin) {
  for (const SkinParameterRange& range : skin_ranges) {
    const double value = skin.*range.value;
    if (value >= range.low && value <= range.high) continue;
    if (std::isinf(value) && range.value == &SkinParameters::dermis_thickness) continue;
    PlainTextStream message;
    message << "skin: " << range.name << " must lie in [" << range.low << ", " << range.high
            << "], but is " << value;
    throw InvalidInput(message.str());
  }
}

bool has_junction(const SkinParameters& skin) {
  return skin.junction_absorption > 0.0 ||
         std::ranges::any_of(skin.inks, [](const SkinInk& ink) { return ink.absorbance > 0.0; });
}

}  // namespace

std::span<const SkinParameterRange> skin_parameter_ranges() { return skin_ranges; }

double eumelanin_absorption(double wavelength) { return 6.6e10 * std::pow(wavelength, -3.33); }

double pheomelanin_absorption(double wavelength) { return 2.9e14 * std::pow(wavelength, -4.75); }

double baseline_absorption(double wavelength) {
  return 0.0244 + 8.53 * std::exp(-(wavelength - 154.0) / 66.2);
}

double oxyhemoglobin_absorption(double wavelength) {
  return absorption(interpolate(oxyhemoglobin_extinction, wavelength), 150.0, 64'500.0);
}

double deoxyhemoglobin_absorption(double wavelength) {
  return absorption(interpolate(deoxyhemoglobin_extinction, wavelength), 150.0, 64'500.0);
}

double carotene_absorption(double wavelength) {
  return absorption(interpolate(carotene_extinction, wavelength), 1.0, 536.87);
}

SkinParameters with_constants(SkinParameters parameters, SkinConstants constants) {
  struct Set {
    double baseline_scale, scattering_scale, scattering_power, saturation;
  };
  const auto [baseline, scattering, power, saturation] = [&]() -> Set {
    switch (constants) {
      case SkinConstants::paper:
        return {1.0, 1.0, 0.0, 0.75};
      case SkinConstants::calibrated_diffusion:
        return {0.207, 0.678, 0.94, 0.626};
      case SkinConstants::calibrated:
        break;
    }
    return {0.084, 0.568, 0.0, 0.624};
  }();
  parameters.baseline_scale = baseline;
  parameters.scattering_scale = scattering;
  parameters.scattering_power = power;
  parameters.saturation_epidermis = parameters.saturation_dermis = saturation;
  return parameters;
}

SkinSpectrum skin_spectrum(double wavelength) {
  return {.eumelanin = eumelanin_absorption(wavelength),
          .pheomelanin = pheomelanin_absorption(wavelength),
          .oxyhemoglobin = oxyhemoglobin_absorption(wavelength),
          .deoxyhemoglobin = deoxyhemoglobin_absorption(wavelength),
          .carotene = carotene_absorption(wavelength),
          .baseline = baseline_absorption(wavelength)};
}

double epidermis_absorption(const SkinParameters& skin, const SkinSpectrum& spectrum) {
  const double melanin =
      skin.melanin_blend * spectrum.eumelanin + (1.0 - skin.melanin_blend) * spectrum.pheomelanin;
  const double rest = 1.0 - skin.melanin - skin.hemoglobin_epidermis - skin.carotene;
  return skin.melanin * melanin +
         skin.hemoglobin_epidermis * blood_absorption(skin.saturation_epidermis, spectrum) +
         skin.carotene * spectrum.carotene + rest * skin.baseline_scale * spectrum.baseline;
}

double dermis_absorption(const SkinParameters& skin, const SkinSpectrum& spectrum) {
  return skin.hemoglobin_dermis * blood_absorption(skin.saturation_dermis, spectrum) +
         (1.0 - skin.hemoglobin_dermis) * skin.baseline_scale * spectrum.baseline;
}

double spectrum_factor(std::span<const std::array<double, 2>> points, double wavelength) {
  if (points.empty()) return 1.0;
  const auto above =
      std::ranges::upper_bound(points, wavelength, {}, [](const auto& point) { return point[0]; });
  if (above == points.begin()) return points.front()[1];
  if (above == points.end()) return points.back()[1];
  const auto& [nm, factor] = *(above - 1);
  return factor + (wavelength - nm) / ((*above)[0] - nm) * ((*above)[1] - factor);
}

double junction_absorbance(const SkinParameters& skin, double wavelength) {
  double sum = spectrum_factor(skin.junction_spectrum, wavelength) * skin.junction_absorption;
  for (const SkinInk& ink : skin.inks)
    sum += spectrum_factor(ink.spectrum, wavelength) * ink.absorbance;
  return sum;
}

double epidermis_absorption(const SkinParameters& skin, double wavelength) {
  return epidermis_absorption(skin, skin_spectrum(wavelength));
}

double dermis_absorption(const SkinParameters& skin, double wavelength) {
  return dermis_absorption(skin, skin_spectrum(wavelength));
}

double epidermis_scattering(const SkinParameters& skin, double wavelength) {
  const double printed = 14.74 * std::pow(wavelength, -0.22) + 2.2e11 * std::pow(wavelength, -4.0);
  return skin.scattering_scale * std::pow(wavelength / 550.0, skin.scattering_power) * printed;
}

double skin_mean_cosine(double wavelength) { return 0.62 + 0.29e-3 * wavelength; }

LayerStack skin_layer_stack(const SkinParameters& skin, double wavelength) {
  check(skin);
  const double g = skin_mean_cosine(wavelength);
  const double sigma_s = epidermis_scattering(skin, wavelength) / (1.0 - g);
  Layer epidermis{.medium = {.sigma_a = epidermis_absorption(skin, wavelength),
                             .sigma_s = sigma_s,
                             .g = g,
                             .ior = ior_epidermis},
                  .thickness = skin.epidermis_thickness};
  Layer junction = epidermis;
  if (has_junction(skin)) {
    junction.medium.sigma_a += 0.5 * junction_absorbance(skin, wavelength) / junction_thickness;
    junction.thickness = junction_thickness;
    epidermis.thickness -= junction_thickness;
  }
  const Layer dermis{.medium = {.sigma_a = dermis_absorption(skin, wavelength),
                                .sigma_s = 0.5 * sigma_s,
                                .g = g,
                                .ior = ior_dermis},
                     .thickness = skin.dermis_thickness};
  std::vector<Layer> layers = {epidermis};
  if (has_junction(skin)) layers.push_back(junction);
  layers.push_back(dermis);
  if (std::isinf(dermis.thickness)) return LayerStack(std::move(layers), 1.0, ior_dermis);
  if (has_junction(skin)) layers.push_back(junction);
  layers.push_back(epidermis);
  return LayerStack(std::move(layers));
}

std::vector<std::string> skin_layer_names(const SkinParameters& skin) {
  std::vector<std::string> names = {"epidermis", "junction", "dermis", "far junction",
                                    "far epidermis"};
  if (std::isinf(skin.dermis_thickness)) names.resize(3);
  if (!has_junction(skin))
    std::erase_if(names, [](const std::string& name) { return name.ends_with("junction"); });
  return names;
}

}  // namespace lamina

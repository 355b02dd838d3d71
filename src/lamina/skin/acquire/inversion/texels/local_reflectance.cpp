// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/acquire/inversion/texels/local_reflectance.h"

#include <algorithm>
#include <cmath>

namespace lamina {
namespace {

// As in SkinReflectanceTable: the logarithm of the reflectance is smooth in the logarithm of the
// epidermis' absorption, and of the root of the dermis', each plus something.
constexpr double slab_scale = 0.1, half_space_scale = 0.15;

std::array<double, 2> coordinates(std::array<double, 2> scaled) {
  return {std::log(scaled[0] + slab_scale), std::log(std::sqrt(scaled[1]) + half_space_scale)};
}
std::array<double, 2> scaled_at(std::array<double, 2> coordinate) {
  const double root = std::max(0.0, std::exp(coordinate[1]) - half_space_scale);
  return {std::max(0.0, std::exp(coordinate[0]) - slab_scale), root * root};
}

/// The most that layers of a range absorb.
std::array<double, 2> most_absorption(const SkinRange& range, const SkinSpectrum& spectrum) {
  std::array<double, 2> most = {};
  for (int corner = 0; corner < 4; ++corner) {
    SkinParameters skin = range.high;
    skin.melanin_blend = corner & 1 ? 1.0 : 0.0;
    skin.saturation_epidermis = skin.saturation_dermis = corner & 2 ? 1.0 : 0.0;
    most[0] = std::max(most[0], epidermis_absorption(skin, spectrum));
    most[1] = std::max(most[1], dermis_absorption(skin, spectrum));
  }
  return most;
}

}  // namespace

LocalReflectance::LocalReflectance(const SkinReflectanceTable& table, const SkinParameters& skin) {
  const SkinRange range = skin_fit_range(skin);
  const std::vector<double>& wavelengths = table.wavelengths();
  for (std::size_t w = 0; w < wavelengths.size(); ++w) {
    const SkinSpectrum spectrum = skin_spectrum(wavelengths[w]);
    const std::array<double, 2> most = most_absorption(range, spectrum);
    const std::array<double, 2> scale = {skin.epidermis_thickness,
                                         2.0 / epidermis_scattering(skin, wavelengths[w])};
    const auto first = coordinates({});
    const auto last = coordinates({most[0] * scale[0], most[1] * scale[1]});
    // One pigment in each layer gives any absorption.
    SkinParameters pure = skin;
    pure.baseline_scale = pure.hemoglobin_epidermis = pure.carotene = 0.0;
    pure.melanin_blend = pure.saturation_dermis = 1.0;
    const auto log_reflectance = [&](double of_epidermis,
                                     double of_dermis) -> std::array<double, 1> {
      const auto scaled = scaled_at({of_epidermis, of_dermis});
      pure.melanin = scaled[0] / scale[0] / spectrum.eumelanin;
      pure.hemoglobin_dermis = scaled[1] / scale[1] / spectrum.oxyhemoglobin;
      return {std::log(table.reflectance_at(w, pure))};
    };
    bands_.push_back({scale, {{first[0], last[0], 64}, {first[1], last[1], 40}, log_reflectance}});
  }
}

LocalReflectance::Value LocalReflectance::at(std::size_t wavelength,
                                             std::array<double, 2> sigma_a) const {
  const Band& band = bands_[wavelength];
  const std::array<double, 2> scaled = {sigma_a[0] * band.scale[0], sigma_a[1] * band.scale[1]};
  const auto [of_epidermis, of_dermis] = coordinates(scaled);
  const auto [logarithm, by] = band.logarithms.at(of_epidermis, of_dermis);
  Value result{.reflectance = std::exp(logarithm[0])};
  const double root = std::sqrt(std::max(scaled[1], 1e-10));
  const std::array<double, 2> chain = {1.0 / (scaled[0] + slab_scale),
                                       0.5 / (root * (root + half_space_scale))};
  for (std::size_t d = 0; d < 2; ++d)
    result.by_sigma_a[d] = result.reflectance * by[d][0] * chain[d] * band.scale[d];
  return result;
}

}  // namespace lamina

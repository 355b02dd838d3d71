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

/// Weights of four neighboring nodes at a share of the way between the middle two (cubic,
/// [Keys1981]), and their derivatives.
struct CubicWeights {
  std::array<double, 4> weight, slope;
};
CubicWeights cubic_weights(double s) {
  return {{0.5 * s * (-1.0 + s * (2.0 - s)), 1.0 + 0.5 * s * s * (-5.0 + 3.0 * s),
           0.5 * s * (1.0 + s * (4.0 - 3.0 * s)), 0.5 * s * s * (s - 1.0)},
          {-0.5 + s * (2.0 - 1.5 * s), s * (-5.0 + 4.5 * s), 0.5 + s * (4.0 - 4.5 * s),
           s * (-1.0 + 1.5 * s)}};
}

}  // namespace

LocalReflectance::LocalReflectance(const SkinReflectanceTable& table, const SkinParameters& skin) {
  const SkinRange range = skin_fit_range(skin);
  const std::vector<double>& wavelengths = table.wavelengths();
  for (std::size_t w = 0; w < wavelengths.size(); ++w) {
    const SkinSpectrum spectrum = skin_spectrum(wavelengths[w]);
    const std::array<double, 2> most = most_absorption(range, spectrum);
    Band& band = bands_.emplace_back();
    band.scale = {skin.epidermis_thickness, 2.0 / epidermis_scattering(skin, wavelengths[w])};
    band.first = coordinates({});
    const auto last = coordinates({most[0] * band.scale[0], most[1] * band.scale[1]});
    for (std::size_t d = 0; d < 2; ++d)
      band.step[d] = (last[d] - band.first[d]) / static_cast<double>(nodes[d] - 1);
    // One pigment in each layer gives any absorption.
    SkinParameters pure = skin;
    pure.baseline_scale = pure.hemoglobin_epidermis = pure.carotene = 0.0;
    pure.melanin_blend = pure.saturation_dermis = 1.0;
    for (std::size_t j = 0; j < nodes[1]; ++j)
      for (std::size_t i = 0; i < nodes[0]; ++i) {
        const auto scaled = scaled_at({band.first[0] + static_cast<double>(i) * band.step[0],
                                       band.first[1] + static_cast<double>(j) * band.step[1]});
        pure.melanin = scaled[0] / band.scale[0] / spectrum.eumelanin;
        pure.hemoglobin_dermis = scaled[1] / band.scale[1] / spectrum.oxyhemoglobin;
        band.logarithms.push_back(std::log(table.reflectance_at(w, pure)));
      }
  }
}

LocalReflectance::Value LocalReflectance::at(std::size_t wavelength,
                                             std::array<double, 2> sigma_a) const {
  const Band& band = bands_[wavelength];
  const std::array<double, 2> scaled = {sigma_a[0] * band.scale[0], sigma_a[1] * band.scale[1]};
  const std::array<double, 2> coordinate = coordinates(scaled);
  std::array<std::size_t, 2> first;
  std::array<CubicWeights, 2> cubic;
  std::array<bool, 2> is_beyond;
  for (std::size_t d = 0; d < 2; ++d) {
    const auto last = static_cast<double>(nodes[d] - 1);
    const double place = (coordinate[d] - band.first[d]) / band.step[d];
    is_beyond[d] = place > last;
    const double inside = std::clamp(place, 0.0, last);
    // At the ends the polynomial of the nearest four nodes goes on.
    const double cell = std::clamp(std::floor(inside), 1.0, last - 2.0);
    cubic[d] = cubic_weights(inside - cell);
    first[d] = static_cast<std::size_t>(cell) - 1;
  }
  double value = 0.0;
  std::array<double, 2> slope = {};
  for (std::size_t j = 0; j < 4; ++j) {
    const double* row = &band.logarithms[(first[1] + j) * nodes[0] + first[0]];
    double along = 0.0, along_slope = 0.0;
    for (std::size_t i = 0; i < 4; ++i) {
      along += cubic[0].weight[i] * row[i];
      along_slope += cubic[0].slope[i] * row[i];
    }
    value += cubic[1].weight[j] * along;
    slope[0] += cubic[1].weight[j] * along_slope;
    slope[1] += cubic[1].slope[j] * along;
  }
  Value result{.reflectance = std::exp(value)};
  const double root = std::sqrt(std::max(scaled[1], 1e-10));
  const std::array<double, 2> chain = {1.0 / (scaled[0] + slab_scale),
                                       0.5 / (root * (root + half_space_scale))};
  for (std::size_t d = 0; d < 2; ++d)
    if (!is_beyond[d])
      result.by_sigma_a[d] =
          result.reflectance * slope[d] / band.step[d] * chain[d] * band.scale[d];
  return result;
}

}  // namespace lamina

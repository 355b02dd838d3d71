// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/reflectance/skin_colors.h"

#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "lamina/base/core/lazy_values.h"
#include "lamina/solve/scattering/diffusion/layered_diffusion.h"
#include "lamina/solve/scattering/diffusion/multipole.h"
#include "lamina/solve/scattering/profile/layer_response.h"

namespace lamina {
namespace {

constexpr std::size_t skins = 150;

/// Skins that fill the ranges of what varies evenly, by a lattice [Roberts2018].
SkinParameters training_skin(SkinParameters skin, std::size_t i) {
  constexpr double steps[] = {0.8566748838545029, 0.733891856627126, 0.6287067210378087,
                              0.5385972572236101};
  double at[4];
  for (int d = 0; d < 4; ++d) {
    const double x = 0.5 + static_cast<double>(i + 1) * steps[d];
    at[d] = x - std::floor(x);
  }
  skin.melanin = 0.004 * std::pow(50.0, at[0]);
  skin.hemoglobin_dermis = 0.001 * std::pow(60.0, at[1]);
  skin.saturation_dermis = skin.saturation_epidermis = 0.3 + 0.7 * at[2];
  skin.melanin_blend = at[3];
  skin.junction_absorption = 0.0;
  return skin;
}

/// What a uniform skin reflects at each wavelength, by diffusion.
std::vector<double> reflectance(const SkinParameters& skin, std::span<const double> wavelengths) {
  std::vector<double> result;
  for (const double wavelength : wavelengths) {
    LayerResponse all;
    for (const Multipole& layer : make_layered_diffusion(skin_layer_stack(skin, wavelength)).layers)
      all = stacked(all, response(layer, 0.0));
    result.push_back(all.reflection_above);
  }
  return result;
}

/// Solves a symmetric, positive definite system for three right sides, by Gauss's elimination.
std::vector<std::array<double, 3>> solve(std::vector<std::vector<double>> a,
                                         std::vector<std::array<double, 3>> b) {
  const std::size_t n = a.size();
  for (std::size_t p = 0; p < n; ++p)
    for (std::size_t i = p + 1; i < n; ++i) {
      const double share = a[i][p] / a[p][p];
      for (std::size_t j = p; j < n; ++j) a[i][j] -= share * a[p][j];
      for (std::size_t c = 0; c < 3; ++c) b[i][c] -= share * b[p][c];
    }
  for (std::size_t p = n; p-- > 0;)
    for (std::size_t c = 0; c < 3; ++c) {
      for (std::size_t j = p + 1; j < n; ++j) b[p][c] -= a[p][j] * b[j][c];
      b[p][c] /= a[p][p];
    }
  return b;
}

BandWeights fitted_weights(const BandSet& bands, const SkinParameters& skin) {
  BandWeights weights = make_band_weights(bands);
  const std::size_t size = bands.size();
  if (bands.is_rgb() || size < 3 || size > 24) return weights;
  std::vector<double> fine;
  for (int nm = 380; nm <= 780; nm += 5) fine.push_back(nm);
  const BandWeights fine_weights = make_band_weights(BandSet(fine));

  // Least squares for the change of all weights but the last, which makes up for the others.
  constexpr double ridge = 3e-4;  // of the change, against relative errors of colours
  const std::size_t n = size - 1;
  std::vector<std::vector<double>> a(n, std::vector<double>(n, 0.0));
  std::vector<std::array<double, 3>> b(n, {0.0, 0.0, 0.0});
  for (std::size_t i = 0; i < n; ++i) a[i][i] = ridge * skins;
  for (std::size_t s = 0; s < skins; ++s) {
    const SkinParameters sample = training_skin(skin, s);
    const std::vector<double> seen = reflectance(sample, bands.wavelengths());
    const LinearSrgb now = linear_srgb(weights, seen);
    const LinearSrgb wanted = linear_srgb(fine_weights, reflectance(sample, fine));
    const double scale = 1.0 / (0.2126 * wanted[0] + 0.7152 * wanted[1] + 0.0722 * wanted[2]);
    for (std::size_t i = 0; i < n; ++i) {
      const double at_i = scale * (seen[i] - seen[n]);
      for (std::size_t j = 0; j < n; ++j) a[i][j] += at_i * scale * (seen[j] - seen[n]);
      for (std::size_t c = 0; c < 3; ++c) b[i][c] += at_i * scale * (wanted[c] - now[c]);
    }
  }
  const std::vector<std::array<double, 3>> change = solve(std::move(a), std::move(b));
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t c = 0; c < 3; ++c) {
      weights[i][c] += change[i][c];
      weights[n][c] -= change[i][c];
    }
  return weights;
}

/// Numbers that tell skins apart.
std::vector<double> numbers_of(const SkinParameters& skin) {
  std::vector<double> numbers;
  for (const SkinParameterRange& range : skin_parameter_ranges())
    numbers.push_back(skin.*range.value);
  const auto add = [&](const std::vector<std::array<double, 2>>& spectrum) {
    numbers.push_back(static_cast<double>(spectrum.size()));
    for (const auto& [nm, factor] : spectrum) numbers.insert(numbers.end(), {nm, factor});
  };
  add(skin.junction_spectrum);
  for (const SkinInk& ink : skin.inks) {
    numbers.push_back(ink.absorbance);
    add(ink.spectrum);
  }
  return numbers;
}

}  // namespace

BandWeights make_skin_band_weights(const BandSet& bands, const SkinParameters& skin) {
  static KeptValues<std::array<std::vector<double>, 2>, BandWeights> kept(16);
  return kept.at({std::vector(bands.wavelengths().begin(), bands.wavelengths().end()),
                  numbers_of(training_skin(skin, 0))},
                 [&] { return fitted_weights(bands, skin); });
}

}  // namespace lamina

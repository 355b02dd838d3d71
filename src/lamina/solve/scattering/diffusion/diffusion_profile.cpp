// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/diffusion/diffusion_profile.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lamina/base/core/error.h"
#include "lamina/base/core/parallel.h"
#include "lamina/solve/scattering/diffusion/diffusion_kernels.h"

namespace lamina {
namespace {

constexpr double trusted = 1e-11;  // of the profile's scale: there rounding is below 1e-3 of it

/// One channel of a table [r, channel].
struct Column {
  std::span<double> table;
  std::size_t channels, channel;
  double& operator[](std::size_t i) const { return table[i * channels + channel]; }
};

/// How fast a profile falls far from the beam: as exp(-kappa r) / r^power. The power is 1/2 for
/// finite layers, whose spectrum has poles, and 2 for a half-space, where it has a cut.
struct Tail {
  double power;
};

/// Replaces a profile by an exponential where it is lost in rounding errors.
///
/// @param scale  integral of the spectrum over k / (2 pi): r * profile(r) cannot exceed it.
void continue_tail(const Column& profile, std::span<const double> r, double scale,
                   const Tail& tail) {
  std::size_t end = r.size();  // of the trusted part
  while (end > 0 && !(std::abs(profile[end - 1]) * r[end - 1] > trusted * scale)) --end;
  if (end == r.size()) return;
  double kappa = 0.0;
  bool has_slope = false;
  if (end >= 2 && profile[end - 1] > 0.0) {
    std::size_t before = end - 1;  // far enough back for a slope
    while (before > 0 && r[before] > 0.9 * r[end - 1]) --before;
    if (profile[before] > profile[end - 1]) {
      const double a = r[before], b = r[end - 1];
      kappa =
          (std::log(profile[before] / profile[end - 1]) - tail.power * std::log(b / a)) / (b - a);
      has_slope = true;
    }
  }
  for (std::size_t i = end; i < r.size(); ++i) {
    if (!has_slope) {
      profile[i] = 0.0;
      continue;
    }
    const double b = r[end - 1];
    profile[i] = profile[end - 1] * std::exp(-std::max(kappa, 0.0) * (r[i] - b)) *
                 std::pow(b / r[i], tail.power);
  }
}

/// Sets negative values to 0. @return the flux taken away.
double clamp_negative(const Column& profile, std::span<const double> r) {
  double flux = 0.0;
  for (std::size_t i = 0; i < r.size(); ++i) {
    if (profile[i] >= 0.0) continue;
    const double log_step = std::log(i > 0 ? r[i] / r[i - 1] : r[1] / r[0]);
    flux -= 2.0 * std::numbers::pi * r[i] * r[i] * log_step * profile[i];
    profile[i] = 0.0;
  }
  return flux;
}

/// Leaves the radii 0, every, 2 every, ...
void keep_every(Profile& profile, std::size_t every) {
  const auto thinned = [&](std::vector<double>& table) {
    std::size_t end = 0;
    for (std::size_t i = 0; i < profile.r.size(); i += every)
      for (std::size_t b = 0; b < profile.bands; ++b) table[end++] = table[i * profile.bands + b];
    table.resize(end);
  };
  thinned(profile.reflectance_profile);
  thinned(profile.transmittance_profile);
}

/// @param models  of the stacks
DiffusionProfile profile_of(std::span<const LayerStack> stacks,
                            std::span<const LayeredDiffusion> models, const HankelPlan& plan) {
  const std::size_t bands = models.size(), channels = 2 * bands;

  DiffusionProfile result;
  Profile& profile = result.profile;
  profile = {.per = ProfilePer::entered_flux, .bands = bands, .r = plan.r};
  std::vector<double> spectra(plan.k.size() * channels);  // [k, channel]: R of all bands, then T
  std::vector<double> scale(channels, 0.0);
  for (std::size_t b = 0; b < bands; ++b) {
    const LayerResponse total = response(models[b], 0.0);
    profile.total_reflectance.push_back(total.reflection_above);
    profile.total_transmittance.push_back(total.transmission_down);
    result.thin_layers.push_back(thin_layers(models[b]));
    const LayerResponse local = local_response(models[b]);
    const StackSpectrum spectrum = stack_spectrum(models[b], plan.k);
    for (std::size_t j = 0; j < plan.k.size(); ++j) {
      spectra[j * channels + b] = spectrum.reflection_above[j] - local.reflection_above;
      spectra[j * channels + bands + b] = spectrum.transmission_down[j] - local.transmission_down;
    }
  }
  for (std::size_t j = 0; j < plan.k.size(); ++j)
    for (std::size_t c = 0; c < channels; ++c)
      scale[c] +=
          plan.k[j] * plan.k_step / (2.0 * std::numbers::pi) * std::abs(spectra[j * channels + c]);

  std::vector<double> table = inverse_hankel(plan, spectra, channels);
  for (std::size_t b = 0; b < bands; ++b) {
    const bool is_infinite = is_semi_infinite(stacks[b]);
    for (const std::size_t c : {b, bands + b})
      continue_tail({table, channels, c}, plan.r, scale[c], {.power = is_infinite ? 2.0 : 0.5});
    result.clamped_reflectance.push_back(clamp_negative({table, channels, b}, plan.r));
    result.clamped_transmittance.push_back(clamp_negative({table, channels, bands + b}, plan.r));
  }
  for (std::size_t i = 0; i < plan.r.size(); ++i) {
    const auto row = table.begin() + static_cast<std::ptrdiff_t>(i * channels);
    const auto half = row + static_cast<std::ptrdiff_t>(bands);
    profile.reflectance_profile.insert(profile.reflectance_profile.end(), row, half);
    profile.transmittance_profile.insert(profile.transmittance_profile.end(), half,
                                         half + static_cast<std::ptrdiff_t>(bands));
  }
  return result;
}

/// Adds the bands of a part to those of the whole, which has all its radii.
void add_bands(DiffusionProfile& whole, const DiffusionProfile& part, std::size_t first) {
  const std::size_t bands = whole.profile.bands, more = part.profile.bands;
  const auto add = [&](std::vector<double>& all, const std::vector<double>& of_part,
                       std::size_t rows) {
    for (std::size_t row = 0; row < rows; ++row)
      std::copy_n(of_part.begin() + static_cast<std::ptrdiff_t>(row * more), more,
                  all.begin() + static_cast<std::ptrdiff_t>(row * bands + first));
  };
  const std::size_t rows = whole.profile.r.size();
  add(whole.profile.reflectance_profile, part.profile.reflectance_profile, rows);
  add(whole.profile.transmittance_profile, part.profile.transmittance_profile, rows);
  add(whole.profile.total_reflectance, part.profile.total_reflectance, 1);
  add(whole.profile.total_transmittance, part.profile.total_transmittance, 1);
  add(whole.clamped_reflectance, part.clamped_reflectance, 1);
  add(whole.clamped_transmittance, part.clamped_transmittance, 1);
  std::ranges::copy(part.thin_layers,
                    whole.thin_layers.begin() + static_cast<std::ptrdiff_t>(first));
}

}  // namespace

DiffusionProfile make_diffusion_profile(std::span<const LayerStack> stacks,
                                        const DiffusionOptions& options, const RadialGrid& grid) {
  // Where rounding takes over, and how steep the profile is there, shows on fine grids only.
  constexpr double fewest_per_decade = 20.0;
  const double decades = std::log10(grid.last / grid.first);
  const auto steps = static_cast<double>(std::max<std::size_t>(grid.size, 2) - 1);
  const double wanted = std::ceil(fewest_per_decade * decades / steps);
  if (!(wanted > 1.0 && wanted < 1e5))
    return make_diffusion_profile(stacks, make_hankel_plan(grid), options);
  const auto every = static_cast<std::size_t>(wanted);
  RadialGrid fine = grid;
  fine.size = (grid.size - 1) * every + 1;
  DiffusionProfile result = make_diffusion_profile(stacks, make_hankel_plan(fine), options);
  keep_every(result.profile, every);
  result.profile.r = radii(grid);
  return result;
}

DiffusionProfile make_diffusion_profile(std::span<const LayerStack> stacks, const HankelPlan& plan,
                                        const DiffusionOptions& options) {
  if (stacks.empty()) throw InvalidInput("bands: at least one is required, but there are 0");
  const std::vector<LayeredDiffusion> models = make_layered_diffusion(stacks, options);
  constexpr std::size_t at_once = 32;  // some 50 ms
  const std::size_t bands = stacks.size();
  if (bands <= at_once) return profile_of(stacks, models, plan);
  DiffusionProfile result;
  result.profile = {.per = ProfilePer::entered_flux, .bands = bands, .r = plan.r};
  for (auto* of_radii :
       {&result.profile.reflectance_profile, &result.profile.transmittance_profile})
    of_radii->resize(plan.r.size() * bands);
  for (auto* of_bands : {&result.profile.total_reflectance, &result.profile.total_transmittance,
                         &result.clamped_reflectance, &result.clamped_transmittance})
    of_bands->resize(bands);
  result.thin_layers.resize(bands);
  parallel_for((bands + at_once - 1) / at_once, [&](std::size_t part) {
    const std::size_t first = part * at_once, count = std::min(at_once, bands - first);
    add_bands(
        result,
        profile_of(stacks.subspan(first, count), std::span(models).subspan(first, count), plan),
        first);
  });
  return result;
}

}  // namespace lamina

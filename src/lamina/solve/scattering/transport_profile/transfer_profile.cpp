// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/transport_profile/transfer_profile.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"
#include "lamina/base/core/parallel.h"
#include "lamina/layers/optics/absorbing_sheet.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"
#include "lamina/solve/scattering/spatial_frequency/rough_inside.h"
#include "lamina/solve/scattering/transport_profile/internal/profile_input.h"
#include "lamina/solve/scattering/transport_profile/internal/transfer_profile_band.h"

namespace lamina {
namespace {

/// Optical thickness that a layer without scattering must have.
constexpr double least_of_absorber = 3.0;

/// A plate that neither scatters nor absorbs much throws rings of light far out by its reflections,
/// of which frequencies show little: errors of 70 % and more, at any thickness. Photons put that
/// right, but not under rough tops.
/// @throws InvalidInput naming the layer.
void refuse_clear_plates_under_rough_tops(std::span<const LayerStack> stacks) {
  for (std::size_t b = 0; b < stacks.size(); ++b)
    for (std::size_t l = 0; l < stacks[b].layers().size(); ++l) {
      if (stacks[b].layers().front().top.roughness == 0.0) break;
      const Layer& layer = stacks[b].layers()[l];
      const double optical_thickness = layer.medium.sigma_a * layer.thickness;
      const bool has_bottom = std::isfinite(layer.thickness);  // else nothing comes back
      if (layer.medium.sigma_s > 0.0 || !has_bottom || is_sheet(layer) ||
          optical_thickness >= least_of_absorber)
        continue;
      throw InvalidInput("band " + std::to_string(b) + ", layer " + std::to_string(l) +
                         ": does not scatter, so its sigma_a times thickness must be at least 3 "
                         "for a profile by radiative transfer under a rough top, but is " +
                         number_text(optical_thickness) + "; monte_carlo takes such plates");
    }
}

/// Of a beam, what leaves below at r = 0 through a rough last boundary: in the total alone.
double light_at_the_axis(const LayerStack& stack, Illumination illumination) {
  if (is_smooth(stack) || illumination == Illumination::diffuse) return 0.0;
  constexpr int nodes = 24, modes = 1;
  return detail::through_rough_bottom(detail::make_frequency_solver(stack, nodes, modes),
                                      detail::Unscattered::by_medium);
}

/// 1 where an error is no smaller than its value.
double relative(double error, double value) {
  return error >= 0.0 && error < value ? error / value : 1.0;
}

}  // namespace

std::vector<LayerStack> lit_from_below(std::span<const LayerStack> stacks) {
  std::vector<LayerStack> turned;
  for (const LayerStack& stack : stacks) {
    const std::string band = "band " + std::to_string(turned.size());
    if (is_semi_infinite(stack))
      throw InvalidInput(band + ": light from below needs a finite last layer, but it is infinite");
    if (stack.ground().reflectance > 0.0)
      throw InvalidInput(band + ": light from below needs a black ground, but its reflectance is " +
                         number_text(stack.ground().reflectance));
    turned.push_back(flipped(stack));
  }
  return turned;
}

void require_transfer_profile(std::span<const LayerStack> stacks,
                              const TransferProfileOptions& options) {
  detail::check_profile_input(stacks, options);
  refuse_clear_plates_under_rough_tops(stacks);
}

TransferProfile transfer_profile(std::span<const LayerStack> stacks, const RadialGrid& radii,
                                 const TransferProfileOptions& options) {
  require_transfer_profile(stacks, options);
  if (options.is_from_below) {
    TransferProfileOptions from_above = options;
    from_above.is_from_below = false;
    return transfer_profile(lit_from_below(stacks), radii, from_above);
  }
  const HankelPlan plan = make_hankel_plan(radii);
  const std::size_t bands = stacks.size(), count = plan.r.size();
  TransferProfile result;
  Profile& profile = result.profile;
  profile.per = ProfilePer::arriving_flux;
  profile.bands = bands;
  profile.r = plan.r;
  profile.reflectance_profile.resize(count * bands);
  profile.transmittance_profile.resize(count * bands);
  result.relative_error.assign(count * bands, 0.0);
  result.transmittance_error.assign(count * bands, 0.0);
  result.estimated_error.assign(bands, 0.0);
  const Incidence incidence{.is_diffuse = options.illumination == Illumination::diffuse};
  const std::vector<AddingDoublingTotals> totals =
      adding_doubling(stacks, incidence,
                      {.accuracy = options.error == ProfileError::mean ? 2e-5 : 1e-6,
                       .progress = options.progress});
  for (const AddingDoublingTotals& of_band : totals) {
    profile.total_reflectance.push_back(of_band.totals.diffuse_reflectance);
    profile.total_transmittance.push_back(of_band.totals.transmittance);
  }

  std::vector<detail::BandProfile> solved(bands);
  parallel_for(bands, [&](std::size_t b) {
    auto flux = detail::flux_of_profile(totals[b], stacks[b], options.illumination);
    flux.transmittance -= light_at_the_axis(stacks[b], options.illumination);
    solved[b] = detail::solve_band(stacks[b], plan, options, flux);
  });
  for (std::size_t b = 0; b < bands; ++b) {
    const detail::BandProfile& band = solved[b];
    result.estimated_error[b] = band.estimated_error;
    result.mean_error.push_back(band.mean_error);
    result.nodes.push_back(band.nodes);
    result.modes.push_back(band.modes);
    result.photons.push_back(band.photons);
    for (std::size_t i = 0; i < count; ++i) {
      profile.reflectance_profile[i * bands + b] = band.profile.reflectance[i];
      profile.transmittance_profile[i * bands + b] = band.profile.transmittance[i];
      result.relative_error[i * bands + b] =
          relative(band.error.reflectance[i], band.profile.reflectance[i]);
      result.transmittance_error[i * bands + b] =
          relative(band.error.transmittance[i], band.profile.transmittance[i]);
    }
  }
  result.is_accurate = std::ranges::all_of(result.estimated_error,
                                           [&](double error) { return error <= options.accuracy; });
  return result;
}

}  // namespace lamina

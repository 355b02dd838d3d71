// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scattering/transport_profile/transfer_profile.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <string>

#include "lamina/core/error.h"
#include "lamina/core/number_text.h"
#include "lamina/core/parallel.h"
#include "lamina/scattering/adding_doubling/adding_doubling.h"
#include "lamina/scattering/spatial_frequency/frequency_response.h"
#include "lamina/scattering/spatial_frequency/scaled_solver.h"
#include "lamina/scattering/transport_profile/internal/transfer_profile_band.h"
#include "lamina/scattering/transport_profile/internal/transfer_profile_cost.h"

namespace lamina {
namespace {

/// Nodes and modes of responses, step by step.
struct Directions {
  int nodes, modes;
};
constexpr std::array<Directions, 6> steps_of_responses = {
    {{7, 4}, {10, 6}, {14, 8}, {19, 10}, {26, 12}, {36, 14}}};
constexpr double most_seconds_of_responses = 2.0;  ///< of a step, as its cost is foreseen
/// Of the response without waves: what is less by this factor need not be known better.
constexpr double least_response = 0.01;
/// Optical thickness that a layer without scattering must have.
constexpr double least_of_absorber = 3.0;
constexpr int fewest_nodes = 6, fewest_modes = 4;  ///< of a profile

void check(std::span<const LayerStack> stacks, const TransferProfileOptions& options) {
  if (!(1e-4 <= options.accuracy && options.accuracy <= 0.1))
    throw InvalidInput("accuracy: must lie in [1e-4, 0.1], but is " +
                       number_text(options.accuracy));
  for (std::size_t b = 0; b < stacks.size(); ++b) {
    const std::string band = "band " + std::to_string(b);
    detail::require_smooth_below_top(stacks[b], "the profile by radiative transfer of " + band);
    const bool scatters = std::any_of(stacks[b].layers().begin(), stacks[b].layers().end(),
                                      [](const Layer& l) { return l.medium.sigma_s > 0.0; });
    if (!scatters) throw InvalidInput(band + ": at least one layer must scatter, but none does");
  }
  detail::require_affordable(detail::solution_cost(stacks, fewest_nodes, fewest_modes, 24));
}

/// Light that the profile adds up to: what leaves scattered; of diffuse light, and under a rough
/// top, all but what the surface alone throws back.
detail::FrequencyResponse flux_of_profile(const AddingDoublingTotals& solved,
                                          const LayerStack& stack, Illumination illumination) {
  const SlabTotals& totals = solved.totals;
  const Layer& first = stack.layers().front();
  if (illumination == Illumination::diffuse ||
      detail::is_rough(first.top, stack.ior_above(), first.medium.ior))
    return {totals.diffuse_reflectance, totals.transmittance};
  return {
      totals.specular_reflectance + totals.diffuse_reflectance - solved.unscattered_reflectance,
      totals.transmittance - (1.0 - stack.ground().reflectance) * solved.unscattered_transmittance};
}

/// A plate that neither scatters nor absorbs much throws rings of light far out by its reflections,
/// of which frequencies show little: errors of 70 % and more, at any thickness. Photons put that
/// right, but not under rough tops.
/// @throws InvalidInput naming the layer.
void refuse_clear_plates_under_rough_tops(std::span<const LayerStack> stacks) {
  for (std::size_t b = 0; b < stacks.size(); ++b)
    for (std::size_t l = 0; l < stacks[b].layers().size() && !is_smooth(stacks[b]); ++l) {
      const Layer& layer = stacks[b].layers()[l];
      const double optical_thickness = layer.medium.sigma_a * layer.thickness;
      const bool has_bottom = std::isfinite(layer.thickness);  // else nothing comes back
      if (layer.medium.sigma_s > 0.0 || !has_bottom || optical_thickness >= least_of_absorber)
        continue;
      throw InvalidInput("band " + std::to_string(b) + ", layer " + std::to_string(l) +
                         ": does not scatter, so its sigma_a times thickness must be at least 3 "
                         "for a profile by radiative transfer under a rough top, but is " +
                         number_text(optical_thickness) + "; monte_carlo takes such plates");
    }
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

TransferProfile transfer_profile(std::span<const LayerStack> stacks, const RadialGrid& radii,
                                 const TransferProfileOptions& options) {
  check(stacks, options);
  refuse_clear_plates_under_rough_tops(stacks);
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
      adding_doubling(stacks, incidence, {.accuracy = 1e-6, .progress = options.progress});
  for (const AddingDoublingTotals& of_band : totals) {
    profile.total_reflectance.push_back(of_band.totals.diffuse_reflectance);
    profile.total_transmittance.push_back(of_band.totals.transmittance);
  }

  std::vector<detail::BandProfile> solved(bands);
  parallel_for(bands, [&](std::size_t b) {
    const auto flux = flux_of_profile(totals[b], stacks[b], options.illumination);
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

SpatialFrequencyResponse spatial_frequency_response(std::span<const LayerStack> stacks,
                                                    std::span<const double> k,
                                                    const TransferProfileOptions& options) {
  check(stacks, options);
  if (options.is_from_below) {
    TransferProfileOptions from_above = options;
    from_above.is_from_below = false;
    return spatial_frequency_response(lit_from_below(stacks), k, from_above);
  }
  for (const double frequency : k)
    if (!(std::isfinite(frequency) && frequency >= 0.0))
      throw InvalidInput("spatial frequency: must be finite and >= 0 [1/mm], but is " +
                         number_text(frequency));
  const std::size_t bands = stacks.size();
  SpatialFrequencyResponse result{.k = {k.begin(), k.end()},
                                  .reflectance = std::vector<double>(k.size() * bands),
                                  .transmittance = std::vector<double>(k.size() * bands),
                                  .reflectance_error = std::vector<double>(k.size() * bands),
                                  .transmittance_error = std::vector<double>(k.size() * bands),
                                  .largest_error = std::vector<double>(bands),
                                  .nodes = std::vector<int>(bands),
                                  .modes = std::vector<int>(bands)};
  if (k.empty()) return result;
  const bool is_diffuse = options.illumination == Illumination::diffuse;
  const std::vector<AddingDoublingTotals> totals =
      adding_doubling(stacks, {.is_diffuse = is_diffuse}, {.accuracy = 1e-6});
  const auto lanes = detail::slabs_at_once();
  for (std::size_t b = 0; b < bands; ++b) {
    const auto flux = flux_of_profile(totals[b], stacks[b], options.illumination);
    std::vector<std::size_t> left(k.size());  // frequencies that are not known well enough
    std::iota(left.begin(), left.end(), std::size_t{0});
    std::vector<double> wrong(k.size());
    for (std::size_t step = 0; step < steps_of_responses.size() && !left.empty(); ++step) {
      const Directions& directions = steps_of_responses[step];
      const auto cost = detail::solution_cost({&stacks[b], 1}, directions.nodes, directions.modes,
                                              static_cast<int>(left.size()));
      if (step > 1 && cost.seconds > most_seconds_of_responses) break;
      const detail::ScaledSolver solver(stacks[b], directions.nodes, directions.modes,
                                        options.illumination, flux);
      const auto respond = [&](std::size_t batch) {
        const auto here =
            std::span(left).subspan(batch * lanes, std::min(lanes, left.size() - batch * lanes));
        std::vector<double> at_k;
        for (const std::size_t i : here) at_k.push_back(k[i]);
        const auto found = solver.at(at_k);
        for (std::size_t j = 0; j < here.size(); ++j) {
          const std::size_t at = here[j] * bands + b;
          const auto change = [&](double value, double without_waves, double& known,
                                  double& error) {
            error = std::abs(value - known);
            known = value;
            const double scale = std::max(std::abs(value), least_response * without_waves);
            return scale > 0.0 ? error / scale : 0.0;
          };
          wrong[here[j]] =
              std::max(change(found[j].reflectance, flux.reflectance, result.reflectance[at],
                              result.reflectance_error[at]),
                       change(found[j].transmittance, flux.transmittance, result.transmittance[at],
                              result.transmittance_error[at]));
        }
      };
      const double part = 1.0 / static_cast<double>(bands * steps_of_responses.size());
      const double before = part * static_cast<double>(b * steps_of_responses.size() + step);
      parallel_for((left.size() + lanes - 1) / lanes, respond,
                   part_of(options.progress, before, before + part));
      result.nodes[b] = directions.nodes;
      result.modes[b] = directions.modes;
      if (step > 0)
        std::erase_if(left, [&](std::size_t i) { return wrong[i] <= options.accuracy; });
    }
    result.largest_error[b] = std::ranges::max(wrong);
  }
  return result;
}

}  // namespace lamina

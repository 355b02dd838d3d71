// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/transport_profile/spatial_frequency_response.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"
#include "lamina/base/core/parallel.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"
#include "lamina/solve/scattering/adding_doubling_derivatives/adding_doubling_derivatives.h"
#include "lamina/solve/scattering/spatial_frequency/scaled_derivatives.h"
#include "lamina/solve/scattering/spatial_frequency/scaled_solver.h"
#include "lamina/solve/scattering/transport_profile/internal/profile_input.h"
#include "lamina/solve/scattering/transport_profile/internal/transfer_profile_cost.h"

namespace lamina {
namespace {

/// Nodes and modes of responses, step by step.
struct Directions {
  int nodes, modes;
};
constexpr std::array<Directions, 6> steps_of_responses = {
    {{7, 4}, {10, 6}, {14, 8}, {19, 10}, {26, 12}, {36, 14}}};
constexpr double most_seconds_of_responses = 2.0;  ///< of a step, as its cost is foreseen
/// Smallest scale of relative errors, over the response without waves;
/// test SpatialFrequencyResponse.KnowsItsError.
constexpr double least_response = 0.01;
constexpr double accuracy_of_totals = 1e-6;

void check_frequencies(std::span<const double> k) {
  for (const double frequency : k)
    if (!(std::isfinite(frequency) && frequency >= 0.0))
      throw InvalidInput("spatial frequency: must be finite and >= 0 [1/mm], but is " +
                         number_text(frequency));
}

/// Responses, and at which step each ended.
struct SteppedResponse {
  SpatialFrequencyResponse response;
  std::vector<std::size_t> step;  ///< [i][band] of steps_of_responses
};

SteppedResponse solve_responses(std::span<const LayerStack> stacks, std::span<const double> k,
                                const TransferProfileOptions& options) {
  const std::size_t bands = stacks.size();
  SteppedResponse stepped{{.k = {k.begin(), k.end()},
                           .reflectance = std::vector<double>(k.size() * bands),
                           .transmittance = std::vector<double>(k.size() * bands),
                           .reflectance_error = std::vector<double>(k.size() * bands),
                           .transmittance_error = std::vector<double>(k.size() * bands),
                           .largest_error = std::vector<double>(bands),
                           .nodes = std::vector<int>(bands),
                           .modes = std::vector<int>(bands)},
                          std::vector<std::size_t>(k.size() * bands)};
  SpatialFrequencyResponse& result = stepped.response;
  if (k.empty()) return stepped;
  const bool is_diffuse = options.illumination == Illumination::diffuse;
  const std::vector<AddingDoublingTotals> totals =
      adding_doubling(stacks, {.is_diffuse = is_diffuse}, {.accuracy = accuracy_of_totals});
  const auto lanes = detail::slabs_at_once();
  for (std::size_t b = 0; b < bands; ++b) {
    const auto flux = detail::flux_of_profile(totals[b], stacks[b], options.illumination);
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
          stepped.step[at] = step;
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
  return stepped;
}

/// The derivatives of flux_of_profile under a smooth top.
detail::FrequencyDerivatives flux_derivatives(const AddingDoublingDerivatives& solved,
                                              const LayerStack& stack, Illumination illumination) {
  detail::FrequencyDerivatives flux{detail::flux_of_profile(solved.totals, stack, illumination),
                                    solved.diffuse_reflectance, solved.transmittance};
  if (illumination == Illumination::diffuse) return flux;
  const auto take_off = [](std::vector<LayerDerivatives>& from, double factor,
                           const std::vector<LayerDerivatives>& unscattered) {
    for (std::size_t l = 0; l < from.size(); ++l)
      for (const auto by : {&LayerDerivatives::by_sigma_a, &LayerDerivatives::by_sigma_s,
                            &LayerDerivatives::by_g, &LayerDerivatives::by_thickness})
        from[l].*by -= factor * (unscattered[l].*by);
  };
  take_off(flux.reflectance, 1.0, solved.unscattered_reflectance);
  take_off(flux.transmittance, 1.0 - stack.ground().reflectance, solved.unscattered_transmittance);
  return flux;
}

TransferProfileOptions from_above(TransferProfileOptions options) {
  options.is_from_below = false;
  return options;
}

}  // namespace

SpatialFrequencyResponse spatial_frequency_response(std::span<const LayerStack> stacks,
                                                    std::span<const double> k,
                                                    const TransferProfileOptions& options) {
  detail::check_profile_input(stacks, options);
  check_frequencies(k);
  if (options.is_from_below)
    return spatial_frequency_response(lit_from_below(stacks), k, from_above(options));
  return solve_responses(stacks, k, options).response;
}

SpatialFrequencyDerivatives spatial_frequency_derivatives(std::span<const LayerStack> stacks,
                                                          std::span<const double> k,
                                                          const TransferProfileOptions& options) {
  detail::check_profile_input(stacks, options);
  check_frequencies(k);
  if (options.is_from_below) {
    auto turned = spatial_frequency_derivatives(lit_from_below(stacks), k, from_above(options));
    for (auto* const all : {&turned.reflectance, &turned.transmittance})
      for (std::vector<LayerDerivatives>& layers : *all) std::ranges::reverse(layers);
    return turned;
  }
  const std::size_t bands = stacks.size();
  const bool is_diffuse = options.illumination == Illumination::diffuse;
  std::vector<detail::FrequencyDerivatives> flux;
  for (const LayerStack& stack : stacks) {
    try {
      const auto solved = adding_doubling_derivatives(
          stack, {.is_diffuse = is_diffuse},
          {.accuracy = accuracy_of_totals, .progress = options.progress});
      flux.push_back(flux_derivatives(solved, stack, options.illumination));
    } catch (const InvalidInput& refusal) {
      throw InvalidInput("band " + std::to_string(flux.size()) + ", " + refusal.what());
    }
  }
  TransferProfileOptions first = options;
  constexpr double of_responses = 0.1;  // of the time
  first.progress = part_of(options.progress, 0.0, of_responses);
  auto [response, step] = solve_responses(stacks, k, first);
  SpatialFrequencyDerivatives result{.response = std::move(response)};
  result.reflectance.resize(k.size() * bands);
  result.transmittance.resize(k.size() * bands);
  for (std::size_t b = 0; b < bands; ++b)
    for (std::size_t s = 0; s < steps_of_responses.size(); ++s) {
      std::vector<std::size_t> here;  // frequencies that ended at this step
      for (std::size_t i = 0; i < k.size(); ++i)
        if (step[i * bands + b] == s) here.push_back(i);
      if (here.empty()) continue;
      const detail::ScaledDerivatives solver(stacks[b], steps_of_responses[s].nodes,
                                             steps_of_responses[s].modes, options.illumination,
                                             flux[b]);
      const double part =
          (1.0 - of_responses) / static_cast<double>(bands * steps_of_responses.size());
      const double before =
          of_responses + part * static_cast<double>(b * steps_of_responses.size() + s);
      parallel_for(
          here.size(),
          [&](std::size_t j) {
            detail::FrequencyDerivatives found = solver.at(k[here[j]]);
            result.reflectance[here[j] * bands + b] = std::move(found.reflectance);
            result.transmittance[here[j] * bands + b] = std::move(found.transmittance);
          },
          part_of(options.progress, before, before + part));
    }
  return result;
}

}  // namespace lamina

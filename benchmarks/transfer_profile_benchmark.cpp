// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// Speed of exact profiles beside their error: three layers of skin, 8 bands, R at 256 radii, the
// error estimate included. The error is the largest relative one against an accuracy of 5e-4,
// within 0.01 to 6 mm wherever a ring of the profile holds more than 1e-4 of the fullest ring's
// flux.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <vector>

#include "lamina/solve/scattering/transport_profile/transfer_profile.h"

namespace lamina {
namespace {

/// Skin of [DonnerJensen2005] Table 3, its coefficients drawn on to 8 bands from red to blue.
std::vector<LayerStack> skin_of_8_bands() {
  constexpr double infinite = std::numeric_limits<double>::infinity();
  std::vector<LayerStack> bands;
  for (int b = 0; b < 8; ++b) {
    const double t = b / 7.0;
    const auto between = [t](double red, double blue) { return red * std::pow(blue / red, t); };
    bands.push_back(LayerStack(
        {{.medium = {between(2.1, 5.0), between(48, 65), 0.0, 1.4}, .thickness = .03},
         {.medium = {between(.16, .30), between(32, 46), .25, 1.34}, .thickness = .05},
         {.medium = {between(.085, 25.0), between(4.5, 4.8), .8, 1.4}, .thickness = infinite}}));
  }
  return bands;
}

double largest_error(const Profile& profile, const Profile& truth) {
  double worst = 0.0;
  for (std::size_t b = 0; b < profile.bands; ++b) {
    double fullest = 0.0;
    const auto ring = [&](std::size_t i) {
      return profile.r[i] * profile.r[i] * truth.reflectance_at(i, b);
    };
    for (std::size_t i = 0; i < profile.r.size(); ++i) fullest = std::max(fullest, ring(i));
    for (std::size_t i = 0; i < profile.r.size(); ++i)
      if (0.01 <= profile.r[i] && profile.r[i] <= 6.0 && ring(i) > 1e-4 * fullest)
        worst = std::max(worst,
                         std::abs(profile.reflectance_at(i, b) / truth.reflectance_at(i, b) - 1.0));
  }
  return worst;
}

/// @param state  its argument is the accuracy asked, in units of 1e-4.
void transfer_profile_of_skin(benchmark::State& state) {
  static const std::vector<LayerStack> stacks = skin_of_8_bands();
  static const TransferProfile truth = transfer_profile(stacks, {}, {.accuracy = 5e-4});
  const double accuracy = 1e-4 * static_cast<double>(state.range(0));
  TransferProfile result;
  for (auto _ : state) result = transfer_profile(stacks, {}, {.accuracy = accuracy});
  state.counters["error"] = largest_error(result.profile, truth.profile);
  state.counters["estimate"] = *std::ranges::max_element(result.estimated_error);
}
BENCHMARK(transfer_profile_of_skin)
    ->Arg(200)
    ->Arg(50)
    ->Arg(25)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime();

}  // namespace
}  // namespace lamina

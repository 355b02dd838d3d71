// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// Speed and error of profiles by layered diffusion: three layers of skin, 8 bands, 256 radii, R and
// T. The error is the largest relative one against converged quadrature, at every eighth radius
// where the profile exceeds 1e-8 of its peak.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "lamina/base/core/quadrature.h"
#include "lamina/solve/scattering/diffusion/diffusion_profile.h"

namespace lamina {
namespace {

/// Skin of [DonnerJensen2005] Table 3, its coefficients drawn on to 8 bands from red to blue; the
/// lowest layer 2 mm thick, so that some light comes through.
std::vector<LayerStack> skin_of_8_bands() {
  std::vector<LayerStack> bands;
  for (int b = 0; b < 8; ++b) {
    const double t = b / 7.0;
    const auto between = [t](double red, double blue) { return red * std::pow(blue / red, t); };
    bands.push_back(LayerStack(
        {{.medium = {between(2.1, 5.0), between(48, 65), 0.0, 1.4}, .thickness = .03},
         {.medium = {between(.16, .30), between(32, 46), .25, 1.34}, .thickness = .05},
         {.medium = {between(.085, 25.0), between(4.5, 4.8), .8, 1.4}, .thickness = 2.0}}));
  }
  return bands;
}

template <class Spectrum>
double by_quadrature(const Spectrum& spectrum, double r, double last_k) {
  static const Quadrature rule = gauss_legendre(12, 0.0, 1.0);
  double sum = 0.0;
  for (double k = 0.0; k < last_k;) {
    const double step = std::min(3.0 / r, 0.02 + 0.25 * k);
    for (std::size_t q = 0; q < rule.nodes.size(); ++q) {
      const double at = k + step * rule.nodes[q];
      sum += step * rule.weights[q] * at * ::j0(at * r) * spectrum(at);
    }
    k += step;
  }
  return sum / (2.0 * std::numbers::pi);
}

double largest_error(const std::vector<LayerStack>& stacks, const Profile& profile) {
  double worst = 0.0;
  for (std::size_t b = 0; b < stacks.size(); b += 7) {
    const LayeredDiffusion model = make_layered_diffusion(stacks[b]);
    for (std::size_t i = 0; i < profile.r.size(); i += 8) {
      const auto compare = [&](double value, double peak, auto part) {
        if (!(value > 1e-8 * peak)) return;
        const double exact =
            by_quadrature([&](double k) { return part(response(model, k)); }, profile.r[i], 3000.0);
        worst = std::max(worst, std::abs(value / exact - 1.0));
      };
      compare(profile.reflectance_at(i, b), profile.reflectance_at(0, b),
              [](const LayerResponse& r) { return r.reflection_above; });
      compare(profile.transmittance_at(i, b), profile.transmittance_at(0, b),
              [](const LayerResponse& r) { return r.transmission_down; });
    }
  }
  return worst;
}

void layered_profile(benchmark::State& state) {
  const std::vector<LayerStack> stacks = skin_of_8_bands();
  const HankelPlan plan = make_hankel_plan({});
  for (auto _ : state) benchmark::DoNotOptimize(make_diffusion_profile(stacks, plan));
  state.counters["relative_error"] =
      largest_error(stacks, make_diffusion_profile(stacks, plan).profile);
  state.counters["frequencies"] = static_cast<double>(plan.k.size());
}
BENCHMARK(layered_profile)->Unit(benchmark::kMicrosecond);

void layered_profile_with_its_plan(benchmark::State& state) {
  const std::vector<LayerStack> stacks = skin_of_8_bands();
  for (auto _ : state) benchmark::DoNotOptimize(make_diffusion_profile(stacks));
}
BENCHMARK(layered_profile_with_its_plan)->Unit(benchmark::kMicrosecond);

void inverse_hankel_of_16_spectra(benchmark::State& state) {
  const HankelPlan plan = make_hankel_plan({});
  std::vector<double> spectra;
  for (const double k : plan.k)
    for (int c = 0; c < 16; ++c) spectra.push_back(std::exp(-0.01 * (c + 1) * k));
  for (auto _ : state) benchmark::DoNotOptimize(inverse_hankel(plan, spectra, 16));
}
BENCHMARK(inverse_hankel_of_16_spectra)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace lamina

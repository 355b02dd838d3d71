// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// The layered BSDF at one point: three layers, eight bands. One item is a value with its density
// for a given direction and one drawn direction with its value and density, as a hit of a path
// needs.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "lamina/core/random.h"
#include "lamina/scattering/layered_bsdf/sampled_layers.h"

namespace {

using namespace lamina;

/// The skin of [DonnerJensen2005] Table 3, its red to blue stretched over eight bands.
std::vector<LayerStack> skin(bool is_matched) {
  std::vector<LayerStack> bands;
  for (int b = 0; b < 8; ++b) {
    const double t = b / 7.0;
    const auto layer = [&](double a0, double a1, double s0, double s1, double g, double ior,
                           double thickness) {
      return Layer{.medium = {.sigma_a = a0 * std::pow(a1 / a0, t),
                              .sigma_s = s0 + t * (s1 - s0),
                              .g = g,
                              .ior = is_matched ? 1.4 : ior},
                   .thickness = thickness};
    };
    bands.push_back(LayerStack(
        {layer(2.1, 5.0, 48.0, 65.0, 0.7, 1.4, 0.03),
         layer(0.16, 0.3, 32.0, 46.0, 0.25, 1.34, 0.05),
         layer(0.085, 25.0, 4.5, 4.8, 0.8, 1.4, std::numeric_limits<double>::infinity())},
        1.0, 1.4));
  }
  return bands;
}

void evaluate_and_sample(benchmark::State& state) {
  const std::vector<LayerStack> bands = skin(state.range(0) != 0);
  const auto stack = make_first_order<8>(bands);
  std::vector<HigherOrders> orders;
  for (const LayerStack& band : bands) orders.push_back(make_higher_orders(band, 1e-3));
  const auto higher = make_higher_order_bands<8>(orders);
  const auto target =
      std::min(static_cast<std::size_t>(state.range(1)), sampled_layers_targets().size() - 1);
  const SampledLayers<8> layers(stack, &higher, {0.6, 0.0, 0.8}, target);
  Random random(1);
  BandValues<8> total;
  for (auto _ : state) {
    const double mu = 0.05 + 0.9 * random.uniform(), x = std::sqrt(1.0 - mu * mu);
    total += layers.evaluate({x, 0.0, mu}).bsdf;
    total += layers.sample(random.uniform_float(), random.uniform_float(), random.uniform_float())
                 .value.bsdf;
  }
  benchmark::DoNotOptimize(total);
  state.SetItemsProcessed(state.iterations());
  state.SetLabel(sampled_layers_targets()[target]);
}
BENCHMARK(evaluate_and_sample)->ArgNames({"matched", "target"})->ArgsProduct({{0, 1}, {0, 1}});

void prepare(benchmark::State& state) {  // what depends on the direction of the eye
  const auto stack = make_first_order<8>(skin(false));
  for (auto _ : state)
    benchmark::DoNotOptimize(SampledLayers<8>(stack, nullptr, {0.6, 0.0, 0.8}).mirrored_inside());
}
BENCHMARK(prepare);

}  // namespace

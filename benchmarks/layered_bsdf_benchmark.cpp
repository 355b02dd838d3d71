// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// The layered BSDF at one point: three layers; 4, 8 or 16 bands. One item is a value with its
// density for a given direction and one drawn direction with its value and density, as a hit of a
// path needs.
#include <benchmark/benchmark.h>
#include <hwy/targets.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "lamina/base/core/random.h"
#include "lamina/solve/scattering/layered_bsdf/sampled_layers.h"

namespace {

using namespace lamina;

/// The skin of [DonnerJensen2005] Table 3, its red to blue stretched over all bands.
std::vector<LayerStack> skin(int count, bool is_matched) {
  std::vector<LayerStack> bands;
  for (int b = 0; b < count; ++b) {
    const double t = b / (count - 1.0);
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

/// @param target  0: the best instruction set that the processor has.
template <int N>
void evaluate_and_sample(benchmark::State& state, bool is_matched, std::int64_t target) {
  const std::vector<LayerStack> bands = skin(N, is_matched);
  const auto stack = make_first_order<N>(bands);
  std::vector<HigherOrders> orders;
  for (const LayerStack& band : bands) orders.push_back(make_higher_orders(band, 1e-3));
  const auto higher = make_higher_order_bands<N>(orders);
  hwy::SetSupportedTargetsForTest(target);
  const SampledLayers<N> layers(stack, &higher, {0.6, 0.0, 0.8});
  hwy::SetSupportedTargetsForTest(0);
  Random random(1);
  BandValues<N> total;
  for (auto _ : state) {
    const double mu = 0.05 + 0.9 * random.uniform(), x = std::sqrt(1.0 - mu * mu);
    total += layers.evaluate({x, 0.0, mu}).bsdf;
    total += layers.sample(random.uniform_float(), random.uniform_float(), random.uniform_float())
                 .value.bsdf;
  }
  benchmark::DoNotOptimize(total);
  state.SetItemsProcessed(state.iterations());
}

template <int N>
void prepare(benchmark::State& state) {  // what depends on the direction of the eye
  const auto stack = make_first_order<N>(skin(N, false));
  for (auto _ : state)
    benchmark::DoNotOptimize(SampledLayers<N>(stack, nullptr, {0.6, 0.0, 0.8}).mirrored_inside());
}

template <int N>
void register_all() {
  const std::string bands = std::to_string(N) + " bands/";
  for (const bool is_matched : {false, true})
    for (const std::int64_t target : {std::int64_t{0}, std::int64_t{HWY_STATIC_TARGET}})
      benchmark::RegisterBenchmark((bands + (is_matched ? "one index/" : "three indices/") +
                                    (target == 0 ? "best" : "baseline"))
                                       .c_str(),
                                   evaluate_and_sample<N>, is_matched, target);
  benchmark::RegisterBenchmark((bands + "prepare").c_str(), prepare<N>);
}

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  register_all<4>();
  register_all<8>();
  register_all<16>();
  benchmark::RunSpecifiedBenchmarks();
}

// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// Time and error of heterogeneous layers: tables, one operator, whole transport.
#include <benchmark/benchmark.h>

#include <cmath>
#include <limits>

#include "lamina/solve/scattering/heterogeneous/transport_gradient.h"

namespace lamina {
namespace {

// Skin in green [Donner2008], scattering as measured skin has it.
MappedStack skin() {
  return {1.0,
          {{17.4, 0.777, 1.4, 0.25}, {8.7, 0.777, 1.38, std::numeric_limits<double>::infinity()}},
          1.38};
}

/// Freckles by a factor of 10 in the epidermis, veins by a factor of 4 in the dermis.
std::vector<Plane> maps(int size) {
  std::vector<Plane> result = {make_plane(size, size), make_plane(size, size)};
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) {
      const auto i = static_cast<std::size_t>(y * size + x);
      result[0].values[i] =
          0.6f * std::exp(1.15f * static_cast<float>(std::sin(0.05 * x) * std::cos(0.07 * y)));
      result[1].values[i] = 0.3f * std::exp(0.7f * static_cast<float>(std::sin(0.02 * (x + y))));
    }
  return result;
}

void tables(benchmark::State& state) {
  for (auto _ : state)
    benchmark::DoNotOptimize(make_stack_tables(
        skin(),
        state.range(0) == 0 ? OperatorTotals::diffusion : OperatorTotals::radiative_transfer,
        std::vector<double>{0.6, 0.3}));
}
BENCHMARK(tables)
    ->Name("tables of a band, 0: diffusion, 1: exact totals")
    ->Arg(0)
    ->Arg(1)
    ->Unit(benchmark::kMillisecond);

void transport_band(benchmark::State& state) {
  const int size = static_cast<int>(state.range(0));
  const StackTables made = make_stack_tables(skin(), OperatorTotals::diffusion);
  const auto layers =
      make_heterogeneous_layers(made, maps(size), {make_plane(size, size, 0.0175f)}, 20.0 / size);
  const Plane light = make_plane(size, size, 1.0f);
  const int bounces = static_cast<int>(state.range(1));
  for (auto _ : state)
    benchmark::DoNotOptimize(transport(layers, light, {.interlayer_bounces = bounces}));
  const double texels = static_cast<double>(size) * size;
  state.counters["s_per_megatexel"] = benchmark::Counter(
      texels / 1e6, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
  state.counters["powers"] = static_cast<double>(layers.layers[0].operators[1].terms);
}
BENCHMARK(transport_band)
    ->Name("transport of a band: side, bounces")
    ->ArgsProduct({{512, 1024}, {2, 4}})
    ->Unit(benchmark::kMillisecond);

void prepare_band(benchmark::State& state) {
  const int size = static_cast<int>(state.range(0));
  const StackTables made = make_stack_tables(skin(), OperatorTotals::diffusion);
  const auto sigma_a = maps(size);
  const std::vector<Plane> sheets = {make_plane(size, size, 0.0175f)};
  for (auto _ : state)
    benchmark::DoNotOptimize(make_heterogeneous_layers(made, sigma_a, sheets, 20.0 / size));
}
BENCHMARK(prepare_band)->Name("maps to coordinates")->Arg(1024)->Unit(benchmark::kMillisecond);

/// Light and the derivatives of a number by all maps, of maps that a fit tries.
void gradient_of_band(benchmark::State& state) {
  const int size = static_cast<int>(state.range(0));
  const StackTables made = make_stack_tables(skin(), OperatorTotals::diffusion);
  const TransportMaps<float> at{
      maps(size), {make_plane(size, size, 0.0175f)}, make_plane(size, size, 1.0f)};
  const AbsorptionRange ranges[] = {{0.18, 1.9}, {0.14, 0.61}};
  DifferentiableTransport<float> model(made, size, size, ranges, 20.0 / size);
  for (auto _ : state) {
    const TransportLight<float> light = model.light(at);
    benchmark::DoNotOptimize(model.gradient({light.reflected, {}}));
  }
}
BENCHMARK(gradient_of_band)
    ->Name("light and gradient of a band: side")
    ->Arg(256)
    ->Arg(512)
    ->Arg(1024)
    ->Unit(benchmark::kMillisecond);

/// What the light changes by when all maps do.
void tangent_of_band(benchmark::State& state) {
  const int size = static_cast<int>(state.range(0));
  const StackTables made = make_stack_tables(skin(), OperatorTotals::diffusion);
  const TransportMaps<float> at{
      maps(size), {make_plane(size, size, 0.0175f)}, make_plane(size, size, 1.0f)};
  const AbsorptionRange ranges[] = {{0.18, 1.9}, {0.14, 0.61}};
  DifferentiableTransport<float> model(made, size, size, ranges, 20.0 / size);
  (void)model.light(at);
  const TransportMaps<float> change{at.sigma_a, {}, {}};
  for (auto _ : state) benchmark::DoNotOptimize(model.tangent(change));
}
BENCHMARK(tangent_of_band)
    ->Name("changes of the light of a band: side")
    ->Arg(256)
    ->Arg(512)
    ->Unit(benchmark::kMillisecond);

void one_operator(benchmark::State& state) {
  const int size = 1024;
  const StackTables made = make_stack_tables(skin(), OperatorTotals::diffusion);
  const auto layers =
      make_heterogeneous_layers(made, maps(size), {make_plane(size, size, 0.0f)}, 20.0 / size);
  const Plane light = make_plane(layers.pyramid.width, layers.pyramid.height, 1.0f);
  const MappedOperator* operators[] = {&layers.layers[0].operators[1]};
  for (auto _ : state)
    benchmark::DoNotOptimize(
        apply_operators(layers.pyramid, light, layers.layers[0].basis, operators));
}
BENCHMARK(one_operator)->Name("one operator, 1024 x 1024")->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace lamina

// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0

// Adding-doubling and exact profiles on the three-layer skin of [DonnerJensen2005] Table 3, red:
// time beside error. Run with --benchmark_min_time=0.5; times are CPU time of one thread.
#include <benchmark/benchmark.h>
#include <hwy/targets.h>

#include <cmath>
#include <limits>
#include <vector>

#include "lamina/base/core/parallel.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"
#include "lamina/solve/scattering/transport_profile/transfer_profile.h"

namespace {

using namespace lamina;

LayerStack skin() {
  constexpr double infinite = std::numeric_limits<double>::infinity();
  return LayerStack(
      {{.medium = {.sigma_a = 2.1, .sigma_s = 48.0, .g = 0.0, .ior = 1.4}, .thickness = 0.03},
       {.medium = {.sigma_a = 0.16, .sigma_s = 32.0, .g = 0.25, .ior = 1.34}, .thickness = 0.05},
       {.medium = {.sigma_a = 0.085, .sigma_s = 4.5, .g = 0.8, .ior = 1.4}, .thickness = infinite}},
      1.0, 1.4);
}

/// Argument: -log10 of the accuracy asked. Counters: the true error and that estimated.
void totals(benchmark::State& state) {
  const LayerStack stack = skin();
  const AddingDoublingOptions options{.accuracy =
                                          std::pow(10.0, -static_cast<double>(state.range(0)))};
  AddingDoublingTotals result;
  for (auto _ : state) benchmark::DoNotOptimize(result = adding_doubling(stack, {}, options));
  const auto fine = adding_doubling(stack, {}, {.accuracy = 1e-10});
  state.counters["error"] =
      std::abs(result.totals.diffuse_reflectance - fine.totals.diffuse_reflectance);
  state.counters["estimated"] = result.estimated_error;
  state.counters["nodes"] = result.nodes;
  state.SetLabel(hwy::TargetName(hwy::SupportedAndGeneratedTargets().front()));
}
BENCHMARK(totals)->Arg(3)->Arg(5)->Arg(8)->Unit(benchmark::kMillisecond);

/// Argument: bands. Half a percent over 0.01 to 6 mm, error estimate included.
void profile_of_bands(benchmark::State& state) {
  const std::vector<LayerStack> bands(static_cast<std::size_t>(state.range(0)), skin());
  TransferProfile result;
  for (auto _ : state) benchmark::DoNotOptimize(result = transfer_profile(bands));
  state.counters["estimated"] = result.estimated_error[0];
  state.counters["threads"] = thread_count();
}
BENCHMARK(profile_of_bands)->Arg(1)->Arg(8)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();

}  // namespace

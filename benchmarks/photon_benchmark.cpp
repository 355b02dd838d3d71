// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// Photons per CPU second of the SIMD kernel, on one thread and for every instruction set of the
// machine, beside MCML's and those of the literal scalar version of the same run.
//
// Columns: photons_per_s; ns_per_event; vs_mcml, the ratio to MCML 1.2.2 (gcc -O3 -march=native, on
// the machine where its numbers were taken); vs_scalar, the ratio to tests/reference; sd, the
// standard deviation of the diffuse reflectance of one photon, which says that Russian roulette has
// not bought speed with noise (with MCML's roulette at 1e-4 it is sd_mcml_roulette).
#include <benchmark/benchmark.h>
#include <hwy/targets.h>

#include <chrono>
#include <cmath>
#include <ctime>
#include <limits>
#include <map>
#include <string>

#include "lamina/base/core/parallel.h"
#include "lamina/solve/scattering/monte_carlo/photon_tracing.h"
#include "solve/scattering/monte_carlo/scalar_photons.h"

namespace {

using namespace lamina;

constexpr double infinite = std::numeric_limits<double>::infinity();

struct Case {
  std::string name;
  LayerStack stack;
  double mcml;  ///< photons/s
  double dr;    ///< [mm]
};

Layer layer(double sigma_a, double sigma_s, double g, double ior, double thickness) {
  return {.medium = {.sigma_a = sigma_a, .sigma_s = sigma_s, .g = g, .ior = ior},
          .thickness = thickness};
}

/// [DonnerJensen2005] Table 3.
LayerStack skin(const double (&sigma_a)[3], const double (&sigma_s)[3]) {
  return LayerStack({layer(sigma_a[0], sigma_s[0], 0.0, 1.4, 0.03),
                     layer(sigma_a[1], sigma_s[1], 0.25, 1.34, 0.05),
                     layer(sigma_a[2], sigma_s[2], 0.8, 1.4, infinite)});
}

std::vector<Case> cases() {
  return {{"a_van_de_hulst", LayerStack({layer(1.0, 9.0, 0.75, 1.0, 0.2)}), 3.97e6, 0.01},
          {"b_half_space", LayerStack({layer(1.0, 9.0, 0.0, 1.5, infinite)}), 374e3, 0.01},
          {"skin_red", skin({2.1, 0.16, 0.085}, {48, 32, 4.5}), 88e3, 0.02},
          {"skin_green", skin({2.1, 0.19, 1.0}, {60, 40, 4.7}), 409e3, 0.02},
          {"skin_blue", skin({5.0, 0.3, 25.0}, {65, 46, 4.8}), 825e3, 0.02},
          {"white_paint", LayerStack({layer(0.01, 100.0, 0.8, 1.5, 1.0)}), 33e3, 0.02}};
}

double cpu_seconds() {
  return static_cast<double>(std::clock()) / static_cast<double>(CLOCKS_PER_SEC);
}

/// Photons per second of the scalar version, measured once per case.
double scalar_rate(const Case& item) {
  static std::map<std::string, double> known;
  if (const auto found = known.find(item.name); found != known.end()) return found->second;
  const int photons = static_cast<int>(item.mcml * 0.3);
  const double start = cpu_seconds();
  benchmark::DoNotOptimize(reference::trace_scalar_photons(item.stack, photons, 1));
  return known[item.name] = photons / (cpu_seconds() - start);
}

void trace(benchmark::State& state, const Case& item, std::int64_t target, bool has_volume) {
  set_thread_count(1);
  hwy::SetSupportedTargetsForTest(target);
  MonteCarloOptions options = {.photons = static_cast<std::uint64_t>(item.mcml * 2.0),
                               .tallies = {.r = {50, item.dr}, .angles = 30}};
  if (has_volume) options.tallies.depth = {100, 0.01};
  double seconds = 0.0, photons = 0.0, events = 0.0, sd = 0.0;
  for (auto _ : state) {
    ++options.seed;
    const double start = cpu_seconds();
    const MonteCarloResult result = trace_photons(item.stack, options);
    seconds += cpu_seconds() - start;
    photons += static_cast<double>(result.photons);
    events += static_cast<double>(result.events);
    sd = result.diffuse_reflectance.standard_error * std::sqrt(static_cast<double>(result.photons));
  }
  options.roulette_weight = 1e-4;
  options.photons /= 20;
  const MonteCarloResult plain = trace_photons(item.stack, options);
  hwy::SetSupportedTargetsForTest(0);
  set_thread_count(0);
  state.counters["photons_per_s"] = photons / seconds;
  state.counters["ns_per_event"] = 1e9 * seconds / events;
  state.counters["vs_mcml"] = photons / seconds / item.mcml;
  state.counters["vs_scalar"] = photons / seconds / scalar_rate(item);
  state.counters["sd"] = sd;
  state.counters["sd_mcml_roulette"] =
      plain.diffuse_reflectance.standard_error * std::sqrt(static_cast<double>(plain.photons));
}

/// Wall-clock speed of all threads over that of one; only an idle machine shows it.
void scale(benchmark::State& state, const Case& item) {
  const MonteCarloOptions options = {.photons = static_cast<std::uint64_t>(item.mcml * 10.0)};
  const auto wall = [&](int threads) {
    set_thread_count(threads);
    const auto start = std::chrono::steady_clock::now();
    benchmark::DoNotOptimize(trace_photons(item.stack, options));
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  };
  for (auto _ : state) {
    const double one = wall(1), two = wall(2);
    state.counters["two_threads"] = one / two;
  }
  set_thread_count(0);
}

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  for (const Case& item : cases()) {
    for (const std::int64_t target : hwy::SupportedAndGeneratedTargets())
      benchmark::RegisterBenchmark(
          (item.name + "/" + hwy::TargetName(target)).c_str(),
          [=](benchmark::State& state) { trace(state, item, target, false); })
          ->Iterations(3)
          ->Unit(benchmark::kMillisecond);
    benchmark::RegisterBenchmark((item.name + "/rz").c_str(),
                                 [=](benchmark::State& state) { trace(state, item, 0, true); })
        ->Iterations(3)
        ->Unit(benchmark::kMillisecond);
  }
  const Case paint = cases().back();
  benchmark::RegisterBenchmark("white_paint/threads",
                               [=](benchmark::State& state) { scale(state, paint); })
      ->Iterations(3)
      ->Unit(benchmark::kMillisecond);
  benchmark::RunSpecifiedBenchmarks();
}

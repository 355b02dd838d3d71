// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
//
// Whole images: CPU time beside the noise that is left, which together are what a method is worth.
#include <benchmark/benchmark.h>

#include <string>

#include "lamina/render/render.h"

namespace lamina {
namespace {

void render_scene(benchmark::State& state, const std::string& name) {
  Scene scene = load_scene(LAMINA_SOURCE_DIR "/scenes/" + name);
  scene.render.samples_per_pixel = static_cast<int>(state.range(0));
  RenderStatistics statistics;
  double cpu_seconds = 0.0;
  for ([[maybe_unused]] auto _ : state) {
    statistics = render(scene).statistics;
    cpu_seconds += statistics.cpu_seconds;
  }
  state.counters["cpu_s"] = cpu_seconds / static_cast<double>(state.iterations());
  state.counters["noise_percent"] = 100.0 * statistics.relative_noise.value_or(0.0);
  state.counters["peak_mib"] = statistics.peak_memory_mib;
}

// 30 000 triangles at 512 x 512; peers at 64 samples: 19 CPU-s at 5.8 % (Burley's profile in
// Cycles), 54 CPU-s at 8.8 % (pbrt-v3).
BENCHMARK_CAPTURE(render_scene, bumpy, "bumpy.json")
    ->Arg(16)
    ->Arg(64)
    ->Unit(benchmark::kSecond)
    ->UseRealTime()
    ->Iterations(1);
BENCHMARK_CAPTURE(render_scene, sphere_skin, "sphere_skin.json")
    ->Arg(16)
    ->Unit(benchmark::kSecond)
    ->UseRealTime()
    ->Iterations(1);

}  // namespace
}  // namespace lamina

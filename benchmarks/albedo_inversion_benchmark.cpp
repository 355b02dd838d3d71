// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0

// Albedos of colors from the table of half-spaces: time beside error. Times are CPU time of one
// thread per color of three channels; errors are the largest of the color, as a share of it,
// against adding-doubling.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "lamina/base/core/random.h"
#include "lamina/solve/albedo_inversion/half_space_color.h"

namespace {

using namespace lamina;

using Rgb = std::array<double, 3>;

std::vector<Rgb> random_colors(std::size_t count) {
  std::vector<Rgb> colors(count);
  Random random = make_random(1, 0);
  for (Rgb& color : colors)
    for (double& channel : color) channel = 0.01 + 0.98 * random.uniform();
  return colors;
}

std::vector<HalfSpaceLook> random_looks(std::size_t count) {
  std::vector<HalfSpaceLook> looks(count);
  Random random = make_random(2, 0);
  for (HalfSpaceLook& look : looks)
    look = {.ior = 1.0 + 0.6 * random.uniform(),
            .g = -0.3 + 1.25 * random.uniform(),
            .top = {.roughness = random.uniform()}};
  return looks;
}

double largest_error(const HalfSpaceLook& look, const std::vector<Rgb>& colors) {
  const HalfSpaceColor half_space(look);
  double largest = 0.0;
  for (std::size_t i = 0; i < 30; ++i) {
    const double color = colors[i][0];
    const double solved = solve_color(look, half_space.albedo(color)).color;
    largest = std::max(largest, std::abs(solved / color - 1.0));
  }
  return largest;
}

/// Colors of a texture: one look.
void colors_of_one_look(benchmark::State& state) {
  const HalfSpaceLook look{.ior = 1.4, .g = 0.8};
  const HalfSpaceColor half_space(look);
  const std::vector<Rgb> colors = random_colors(1024);
  Rgb albedo = {};
  std::size_t i = 0;
  for (auto _ : state) {
    const Rgb& color = colors[++i % colors.size()];
    for (std::size_t c = 0; c < 3; ++c) albedo[c] = half_space.albedo(color[c]);
    benchmark::DoNotOptimize(albedo);
  }
  state.counters["error"] = largest_error(look, colors);
}
BENCHMARK(colors_of_one_look)->Unit(benchmark::kNanosecond);

/// A look of its own for each color.
void colors_of_any_look(benchmark::State& state) {
  const std::vector<HalfSpaceLook> looks = random_looks(256);
  const std::vector<Rgb> colors = random_colors(1024);
  Rgb albedo = {};
  std::size_t i = 0;
  for (auto _ : state) {
    ++i;
    const HalfSpaceColor half_space(looks[i % looks.size()]);
    for (std::size_t c = 0; c < 3; ++c) albedo[c] = half_space.albedo(colors[i % 1024][c]);
    benchmark::DoNotOptimize(albedo);
  }
}
BENCHMARK(colors_of_any_look)->Unit(benchmark::kNanosecond);

/// Without a table: an albedo's color by the solver that the table is made with.
void color_by_adding_doubling(benchmark::State& state) {
  SolvedColor solved;
  for (auto _ : state) benchmark::DoNotOptimize(solved = solve_color({.ior = 1.4, .g = 0.8}, 0.99));
  state.counters["estimated"] = solved.estimated_error;
}
BENCHMARK(color_by_adding_doubling)->Unit(benchmark::kMillisecond);

}  // namespace

// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// How far the table of half-spaces is off: random looks and colors, inverted and solved again; the
// table of docs/albedo_inversion.md. `half_space_errors SMOOTH ROUGH`, 3000 and 200 if not given.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "lamina/base/core/parallel.h"
#include "lamina/base/core/random.h"
#include "lamina/solve/albedo_inversion/half_space_color.h"

namespace {

using namespace lamina;

/// Errors of as many colors, as shares of them; half of the indices are below 1.1.
std::vector<double> errors(ColorDefinition definition, bool is_rough, int count) {
  std::vector<double> found(static_cast<std::size_t>(count));
  parallel_for(found.size(), [&](std::size_t i) {
    Random random = make_random(is_rough ? 11 : 10, i);
    const double share = random.uniform();
    HalfSpaceLook look{.ior = 1.0 + (random.uniform() < 0.5 ? 0.1 * share * share : 0.6 * share),
                       .g = -0.3 + 1.25 * random.uniform(),
                       .definition = definition};
    if (is_rough)
      look.top = {.roughness = random.uniform(),
                  .distribution = random.uniform() < 0.5 ? MicrofacetDistribution::beckmann
                                                         : MicrofacetDistribution::ggx};
    const HalfSpaceColor half_space(look);
    const double low = std::max(0.01, half_space.darkest());
    const double high = std::min(0.99, half_space.brightest());
    const double wanted = low * std::pow(high / low, random.uniform());
    found[i] = std::abs(solve_color(look, half_space.albedo(wanted)).color / wanted - 1.0);
  });
  std::ranges::sort(found);
  return found;
}

}  // namespace

int main(int count, char** arguments) {
  const std::array numbers = {count > 1 ? std::atoi(arguments[1]) : 3000,
                              count > 2 ? std::atoi(arguments[2]) : 200};
  std::printf(
      "| definition | surface | colors | rms %% | 99 of 100 below %% | largest %% |\n"
      "|---|---|---|---|---|---|\n");
  for (const bool is_rough : {false, true})
    for (const auto& definition : enum_names<ColorDefinition>) {
      const auto found = errors(definition.value, is_rough, numbers[is_rough ? 1 : 0]);
      double squares = 0.0;
      for (const double error : found) squares += error * error;
      const auto size = static_cast<double>(found.size());
      std::printf("| `%s` | %s | %zu | %.4f | %.4f | %.4f |\n", definition.name.data(),
                  is_rough ? "rough" : "smooth", found.size(), 100.0 * std::sqrt(squares / size),
                  100.0 * found[static_cast<std::size_t>(0.99 * (size - 1.0))],
                  100.0 * found.back());
      std::fflush(stdout);
    }
}

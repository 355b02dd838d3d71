// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// Prints docs/validation.md's table of photon Monte Carlo: published anchors, then every stack of
// tests/reference/stack_table.h against adding-doubling, value ± standard error beside the
// reference, deviations in standard errors, and chi-square over all.
//
//   validation_table [PHOTONS] > table.md
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>

#include "lamina/scattering/adding_doubling.h"
#include "lamina/scattering/photon_tracing.h"
#include "reference/stack_table.h"

namespace {

using namespace lamina;

double chi_square = 0.0;
int count = 0;
std::uint64_t seed = 0;  // each stack has its own, so that their errors are independent

void row(const std::string& name, const char* quantity, const Estimate& estimate,
         double reference) {
  const double deviation = (estimate.value - reference) / estimate.standard_error;
  chi_square += deviation * deviation;
  ++count;
  std::printf("| %s | %s | %.6f ± %.6f | %.6f | %+.1f |\n", name.c_str(), quantity, estimate.value,
              estimate.standard_error, reference, deviation);
}

void anchor(const char* name, const Medium& medium, double thickness, double reflectance,
            double transmittance, std::uint64_t photons) {
  const LayerStack stack({{.medium = medium, .thickness = thickness}});
  const MonteCarloResult result = trace_photons(stack, {.photons = photons, .seed = ++seed});
  row(name, "R", result.diffuse_reflectance, reflectance);
  if (transmittance > 0.0) row(name, "T", result.transmittance, transmittance);
}

}  // namespace

int main(int argc, char** argv) {
  const std::uint64_t photons = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 4'000'000;
  constexpr double infinite = std::numeric_limits<double>::infinity();
  std::printf(
      "Photons: %llu per stack, seeds 1, 2, ... R is diffuse reflectance, T transmittance.\n\n",
      static_cast<unsigned long long>(photons));
  std::puts("| stack | | Monte Carlo | reference | deviation [standard errors] |");
  std::puts("|---|---|---|---|---|");
  anchor("van de Hulst: slab, published", {.sigma_a = 1.0, .sigma_s = 9.0, .g = 0.75}, 0.2,
         0.0973946, 0.6609577, photons);
  anchor("Giovanelli: half-space, published", {.sigma_a = 1.0, .sigma_s = 9.0, .ior = 1.5},
         infinite, 0.2599186 - 0.04, 0.0, photons);
  for (const auto& [name, stack] : reference::stack_table()) {
    const MonteCarloResult result = trace_photons(stack, {.photons = photons, .seed = ++seed});
    const SlabTotals totals = adding_doubling(stack, {}, {.accuracy = 1e-6}).totals;
    row(name, "R", result.diffuse_reflectance, totals.diffuse_reflectance);
    if (totals.transmittance > 1e-5) row(name, "T", result.transmittance, totals.transmittance);
  }
  std::printf("\nChi-square: %.1f over %d numbers.\n", chi_square, count);
}

// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// Prints the tables of docs/validation.md: adding-doubling beside published values; then published
// values and every stack of tests/literal/stack_table.h by photon Monte Carlo, value ± standard
// error beside adding-doubling, deviations in standard errors, and chi-square.
//
//   validation_table [PHOTONS [SEED [NAME]]] > tables.md
//
// SEED is that of the first stack; with NAME only the stacks so called.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <numbers>
#include <optional>
#include <string>

#include "lamina/base/core/quadrature.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"
#include "lamina/solve/scattering/monte_carlo/photon_tracing.h"
#include "literal/h_function.h"
#include "literal/stack_table.h"

namespace {

using namespace lamina;

constexpr double infinite = std::numeric_limits<double>::infinity();

/// Plane albedo of an isotropic half-space, 1 - sqrt(1 - W) H(mu). Source: [Chandrasekhar1960] §38.
double plane_albedo(double albedo, double mu) {
  return 1.0 - std::sqrt(1.0 - albedo) * reference::h_function(albedo, mu);
}

SlabTotals solve(const LayerStack& stack, double degrees = 0.0) {
  return adding_doubling(stack, {.theta = degrees * std::numbers::pi / 180.0}, {.accuracy = 1e-8})
      .totals;
}

void print_adding_doubling() {
  const auto row = [](const std::string& name, double value, double published) {
    std::printf("| %s | %.7f | %.7f | %.0e |\n", name.c_str(), value, published,
                std::abs(value - published));
  };
  std::puts("| case | adding–doubling | reference | difference |\n|---|---|---|---|");
  const SlabTotals slab = solve(
      LayerStack({{.medium = {.sigma_a = 1.0, .sigma_s = 9.0, .g = 0.75}, .thickness = 0.2}}));
  row("van de Hulst: slab, diffuse reflectance", slab.diffuse_reflectance, 0.0973946);
  row("the same, transmittance", slab.transmittance, 0.6609577);
  const SlabTotals half_space =
      solve(LayerStack({{.medium = {.sigma_a = 1.0, .sigma_s = 9.0, .ior = 1.5}}}));
  row("Giovanelli: half-space, total reflectance",
      half_space.diffuse_reflectance + half_space.specular_reflectance, 0.2599186);
  for (const auto& [name, stack] : reference::stack_table()) {
    if (!name.starts_with("skin")) continue;
    const double published = name == "skin, red"     ? 0.398083
                             : name == "skin, green" ? 0.392509
                                                     : 0.309059;
    row("Donner & Jensen: " + name + ", diffuse reflectance", solve(stack).diffuse_reflectance,
        published);
  }
  for (const double albedo : {0.2, 0.8, 0.99})
    for (const double degrees : {0.0, 75.0}) {
      char name[80];
      std::snprintf(name, sizeof name, "isotropic half-space, albedo %.2g, from %.0f°, by H",
                    albedo, degrees);
      const LayerStack stack({{.medium = {.sigma_a = 1.0 - albedo, .sigma_s = albedo}}});
      row(name, solve(stack, degrees).diffuse_reflectance,
          plane_albedo(albedo, std::cos(degrees * std::numbers::pi / 180.0)));
    }
}

/// A table of photon Monte Carlo.
class Comparison {
 public:
  Comparison(std::uint64_t photons, std::uint64_t seed, std::string name)
      : photons_(photons), seed_(seed), name_(std::move(name)) {
    std::printf(
        "Photons: %llu per stack, seeds %llu, %llu, ... R is diffuse reflectance, T "
        "transmittance.\n\n| stack | | Monte Carlo | reference | deviation [standard errors] |\n"
        "|---|---|---|---|---|\n",
        static_cast<unsigned long long>(photons), static_cast<unsigned long long>(seed),
        static_cast<unsigned long long>(seed + 1));
  }

  /// Each stack has its own seed, so that their errors are independent.
  void add(const std::string& name, const LayerStack& stack,
           const std::optional<SlabTotals>& published = {}) {
    const std::uint64_t seed = seed_++;
    if (!name_.empty() && name != name_) return;
    const SlabTotals reference = published ? *published : solve(stack);
    const MonteCarloResult result = trace_photons(stack, {.photons = photons_, .seed = seed});
    row(name, "R", result.diffuse_reflectance, reference.diffuse_reflectance);
    if (reference.transmittance > 1e-5)
      row(name, "T", result.transmittance, reference.transmittance);
  }

  void print_chi_square() const {
    std::printf("\nChi-square: %.1f over %d numbers.\n", chi_square_, count_);
  }

 private:
  void row(const std::string& name, const char* quantity, const Estimate& estimate,
           double reference) {
    const double deviation = (estimate.value - reference) / estimate.standard_error;
    chi_square_ += deviation * deviation;
    ++count_;
    std::printf("| %s | %s | %.6f ± %.6f | %.6f | %+.1f |\n", name.c_str(), quantity,
                estimate.value, estimate.standard_error, reference, deviation);
    std::fflush(stdout);
  }

  std::uint64_t photons_, seed_;
  std::string name_;
  double chi_square_ = 0.0;
  int count_ = 0;
};

}  // namespace

int main(int argc, char** argv) {
  const std::uint64_t photons = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 4'000'000;
  const std::uint64_t seed = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1;
  const std::string name = argc > 3 ? argv[3] : "";
  std::puts("Adding–doubling\n");
  print_adding_doubling();

  std::puts("\nPhoton Monte Carlo, smooth boundaries\n");
  Comparison smooth(photons, seed, name);
  smooth.add(
      "van de Hulst: slab, published",
      LayerStack({{.medium = {.sigma_a = 1.0, .sigma_s = 9.0, .g = 0.75}, .thickness = 0.2}}),
      SlabTotals{.diffuse_reflectance = 0.0973946, .transmittance = 0.6609577});
  smooth.add("Giovanelli: half-space, published",
             LayerStack({{.medium = {.sigma_a = 1.0, .sigma_s = 9.0, .ior = 1.5}}}),
             SlabTotals{.diffuse_reflectance = 0.2599186 - 0.04});
  for (const auto& [called, stack] : reference::stack_table()) smooth.add(called, stack);
  smooth.print_chi_square();

  std::puts("\nPhoton Monte Carlo, rough boundaries\n");
  Comparison rough(photons / 4, seed + 100, name);
  for (const auto& [called, stack] : reference::rough_stack_table()) rough.add(called, stack);
  rough.print_chi_square();
}

// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// Runs tiny cases of the solvers behind the readers: any stack of layers within the limits of
// files. All results must be finite, and what is reflected, transmitted and absorbed must be the
// light.
#include <fuzzer/FuzzedDataProvider.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <numbers>

#include "fuzz_input.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"
#include "lamina/solve/scattering/diffusion/diffusion_profile.h"
#include "lamina/solve/scattering/diffusion/layered_diffusion.h"
#include "lamina/solve/scattering/monte_carlo/photon_tracing.h"

namespace {

using namespace lamina;

void require(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "%s\n", what);
  std::abort();
}

/// 0, or one of all orders of magnitude that files may hold.
double coefficient(FuzzedDataProvider& input) {
  if (input.ConsumeIntegralInRange(0, 7) == 0) return 0.0;
  return std::pow(10.0, input.ConsumeFloatingPointInRange(-9.0, 9.0));
}

/// Any cosine, and often one of those at which formulas end.
double mean_cosine(FuzzedDataProvider& input) {
  constexpr double ends[] = {0.0, 1.0 - 1e-9, -1.0 + 1e-9, 1e-12};
  if (input.ConsumeBool()) return input.PickValueInArray(ends);
  return input.ConsumeFloatingPointInRange(-0.999, 0.999);
}

double index(FuzzedDataProvider& input) {
  constexpr double some[] = {1.0, 1.0 + 1e-12, 1.33, 1.4, 2.5};
  if (input.ConsumeBool()) return input.PickValueInArray(some);
  return input.ConsumeFloatingPointInRange(0.3, 5.0);
}

Interface boundary(FuzzedDataProvider& input, bool may_be_rough) {
  Interface result;
  if (may_be_rough && input.ConsumeIntegralInRange(0, 15) == 0)
    result = {input.ConsumeFloatingPointInRange(0.0, 1.0),
              input.ConsumeBool() ? MicrofacetDistribution::ggx : MicrofacetDistribution::beckmann};
  return result;
}

LayerStack stack_of(FuzzedDataProvider& input, bool may_be_rough) {
  std::vector<Layer> layers(input.ConsumeIntegralInRange<std::size_t>(1, 3));
  for (Layer& layer : layers) {
    layer.medium = {.sigma_a = coefficient(input),
                    .sigma_s = coefficient(input),
                    .g = mean_cosine(input),
                    .ior = index(input)};
    layer.thickness = std::pow(10.0, input.ConsumeFloatingPointInRange(-6.0, 4.0));
    layer.top = boundary(input, may_be_rough);
  }
  double below = index(input);
  if (input.ConsumeBool()) {
    layers.back().thickness = std::numeric_limits<double>::infinity();
    below = layers.back().medium.ior;
  }
  Ground ground;
  if (input.ConsumeBool() && std::isfinite(layers.back().thickness))
    ground.reflectance = input.ConsumeProbability<double>();
  return LayerStack(std::move(layers), index(input), below, ground);
}

void check(const SlabTotals& totals, double tolerance, const char* who) {
  double sum = totals.specular_reflectance + totals.diffuse_reflectance + totals.transmittance;
  for (const double part : totals.absorptance) sum += part;
  require(std::isfinite(sum), who);
  require(std::abs(sum - 1.0) <= tolerance, who);
}

void run_adding_doubling(FuzzedDataProvider& input) {
  const LayerStack stack = stack_of(input, true);
  const Incidence incidence{
      .theta = input.ConsumeFloatingPointInRange(0.0, std::numbers::pi / 2.0 - 1e-6)};
  const auto result = adding_doubling(stack, incidence, {.accuracy = 1e-2, .max_nodes = 8});
  check(result.totals, 0.05, "adding_doubling: the totals do not add up to the light");
}

void run_photons(FuzzedDataProvider& input) {
  MonteCarloOptions options{.photons = 64};
  options.max_events = 2000;
  options.tallies.r = {.count = 4, .width = 0.1};
  options.tallies.angles = 3;
  options.tallies.depth = {.count = 4, .width = 0.1};
  options.incidence.theta = input.ConsumeFloatingPointInRange(0.0, 1.5);
  const MonteCarloResult result = trace_photons(stack_of(input, true), options);
  double sum = result.specular_reflectance.value + result.diffuse_reflectance.value +
               result.transmittance.value + result.unfinished.value;
  for (const Estimate& part : result.absorptance) sum += part.value;
  require(std::isfinite(sum) && sum >= 0.0, "trace_photons: a total is not finite");
  for (const Estimate& density : result.radial.reflection)
    require(std::isfinite(density.value), "trace_photons: R(r) is not finite");
}

void run_diffusion(FuzzedDataProvider& input) {
  const LayerStack stack = stack_of(input, false);
  const DiffusionProfile result = make_diffusion_profile({&stack, 1}, {}, {.size = 16});
  for (const double value : result.profile.reflectance_profile)
    require(std::isfinite(value), "make_diffusion_profile: R(r) is not finite");
  const SlabTotals totals = diffusion_totals(stack, {});
  require(std::isfinite(totals.diffuse_reflectance + totals.transmittance),
          "diffusion_totals: a total is not finite");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  FuzzedDataProvider input(data, size);
  return fuzz::read_or_refuse([&] {
    switch (input.ConsumeIntegralInRange(0, 2)) {
      case 0:
        return run_adding_doubling(input);
      case 1:
        return run_photons(input);
      default:
        return run_diffusion(input);
    }
  });
}

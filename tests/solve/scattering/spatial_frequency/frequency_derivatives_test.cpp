// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/spatial_frequency/frequency_derivatives.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "lamina/solve/scattering/adding_doubling_derivatives/adding_doubling_derivatives.h"
#include "solve/scattering/layer_parameters.h"

namespace lamina {
namespace {

constexpr double endless = std::numeric_limits<double>::infinity();

Layer of(double sigma_a, double sigma_s, double g, double ior, double thickness) {
  return {.medium = {.sigma_a = sigma_a, .sigma_s = sigma_s, .g = g, .ior = ior},
          .thickness = thickness};
}

struct Case {
  const char* name;
  LayerStack stack;
};
/// One to four layers: matched and refracting, forward and backward scattering, a ground, a clear
/// plate, a half-space.
const std::vector<Case> cases{
    {"slab", LayerStack({of(.2, 3, .8, 1, .7)})},
    {"half-space", LayerStack({of(.5, 4, 0, 1.3, .2), of(.02, 10, .95, 1.4, endless)}, 1, 1.4)},
    {"three layers, ground",
     LayerStack({of(1, 5, .9, 1.4, .1), of(.1, 20, .7, 1.34, .5), of(.4, 2, -.3, 1.5, .3)}, 1, 1.6,
                {.reflectance = .6})},
    {"four layers, clear plate", LayerStack({of(.3, 0, 0, 1.5, .2), of(.05, 8, .6, 1.33, .4),
                                             of(1, 30, .95, 1.33, .1), of(.02, 1, .3, 1.45, 1)})},
};

constexpr int nodes = 5, modes = 3;

detail::FrequencyResponse respond(const LayerStack& stack, Illumination illumination, double k) {
  const auto solver = detail::make_frequency_solver(stack, nodes, modes);
  return illumination == Illumination::diffuse ? detail::diffuse_responses(solver, {&k, 1}).front()
                                               : detail::response(solver, k);
}

TEST(FrequencyDerivatives, AreThoseOfCentralDifferences) {
  for (const auto& [name, stack] : cases)
    for (const auto& [illumination, k] :
         {std::pair{Illumination::normal_beam, .2}, std::pair{Illumination::normal_beam, 5.},
          std::pair{Illumination::diffuse, 1.}}) {
      const auto exact = detail::response_derivatives(
          detail::differentiate_solver(stack, detail::make_frequency_solver(stack, nodes, modes)),
          illumination, k);
      const auto value = respond(stack, illumination, k);
      EXPECT_NEAR(exact.response.reflectance, value.reflectance, 1e-12);
      EXPECT_NEAR(exact.response.transmittance, value.transmittance, 1e-12);
      for (std::size_t l = 0; l < stack.layers().size(); ++l)
        for (const LayerParameter& parameter : layer_parameters) {
          Layer layer = stack.layers()[l];
          const double at = parameter.value(layer);
          const bool is_g = std::string(parameter.name) == "g";
          if (!std::isfinite(at) || (!is_g && at == 0.0)) continue;
          // A quotient over h and one over 2 h: what is left is of order h^4.
          const double h = is_g ? 5e-4 : 1e-3 * at;
          const auto move = [&](double by) {
            return respond(changed(stack, l, parameter, by), illumination, k);
          };
          const auto r1 = move(h), r2 = move(-h), r3 = move(2.0 * h), r4 = move(-2.0 * h);
          const auto expect = [&](const char* what, double derivative,
                                  double detail::FrequencyResponse::*of) {
            const double expected = (8.0 * (r1.*of - r2.*of) - (r3.*of - r4.*of)) / (12.0 * h);
            EXPECT_NEAR(derivative, expected, 1e-6 * std::abs(expected) + 1e-12 / h)
                << name << ": " << what << " by " << parameter.name << " of layer " << l << ", k "
                << k;
          };
          expect("R", exact.reflectance[l].*parameter.derivative,
                 &detail::FrequencyResponse::reflectance);
          expect("T", exact.transmittance[l].*parameter.derivative,
                 &detail::FrequencyResponse::transmittance);
        }
    }
}

// Without waves: those of adding-doubling, solved another way, on the same directions.
TEST(FrequencyDerivatives, AreThoseOfTotalsAtZeroFrequency) {
  for (const auto& [name, stack] : cases) {
    const auto waves = detail::response_derivatives(
        detail::differentiate_solver(stack, detail::make_frequency_solver(stack, nodes, 2)),
        Illumination::diffuse, 0.0);
    const auto totals = adding_doubling_derivatives(stack, {.is_diffuse = true},
                                                    {.accuracy = 1e-10, .max_nodes = nodes});
    ASSERT_EQ(totals.totals.nodes, nodes);
    for (std::size_t l = 0; l < stack.layers().size(); ++l)
      for (const LayerParameter& parameter : layer_parameters) {
        const auto expect = [&](const char* what, double found, double expected) {
          EXPECT_NEAR(found, expected, 1e-9 * (1.0 + std::abs(expected)))
              << name << ": " << what << " by " << parameter.name << " of layer " << l;
        };
        expect("R", waves.reflectance[l].*parameter.derivative,
               totals.diffuse_reflectance[l].*parameter.derivative);
        expect("T", waves.transmittance[l].*parameter.derivative,
               totals.transmittance[l].*parameter.derivative);
      }
  }
}

// Two halves are the whole.
TEST(FrequencyDerivatives, OfHalvesAddUp) {
  const Layer whole = of(.3, 6, .8, 1.4, .8);
  Layer half = whole;
  half.thickness *= .5;
  const double k = 1.5;
  const auto derivatives = [&](const LayerStack& stack) {
    return detail::response_derivatives(
        detail::differentiate_solver(stack, detail::make_frequency_solver(stack, nodes, modes)),
        Illumination::normal_beam, k);
  };
  const auto one = derivatives(LayerStack({whole})), two = derivatives(LayerStack({half, half}));
  for (const auto total :
       {&detail::FrequencyDerivatives::reflectance, &detail::FrequencyDerivatives::transmittance}) {
    const LayerDerivatives &all = (one.*total)[0], &upper = (two.*total)[0],
                           &lower = (two.*total)[1];
    EXPECT_NEAR(all.by_sigma_a, upper.by_sigma_a + lower.by_sigma_a, 1e-9);
    EXPECT_NEAR(all.by_sigma_s, upper.by_sigma_s + lower.by_sigma_s, 1e-9);
    EXPECT_NEAR(all.by_g, upper.by_g + lower.by_g, 1e-9);
    EXPECT_NEAR(all.by_thickness, upper.by_thickness, 1e-9);
    EXPECT_NEAR(all.by_thickness, lower.by_thickness, 1e-9);
  }
}

}  // namespace
}  // namespace lamina

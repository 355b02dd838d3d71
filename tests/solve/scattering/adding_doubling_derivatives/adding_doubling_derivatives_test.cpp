// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/adding_doubling_derivatives/adding_doubling_derivatives.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "lamina/base/core/error.h"
#include "solve/scattering/layer_parameters.h"

namespace lamina {
namespace {

constexpr double endless = std::numeric_limits<double>::infinity();

Layer of(double sigma_a, double sigma_s, double g, double ior, double thickness) {
  return {.medium = {.sigma_a = sigma_a, .sigma_s = sigma_s, .g = g, .ior = ior},
          .thickness = thickness};
}

/// Always the same grid: the accuracy is out of reach.
const AddingDoublingOptions one_grid{.accuracy = 1e-10, .max_nodes = 9};

struct Case {
  const char* name;
  LayerStack stack;
  Incidence incidence;
};

/// Slabs and stacks of all kinds: matched and refracting, forward and backward scattering, a
/// ground, a clear plate, a half-space, isotropic scattering, next to no absorption.
std::vector<Case> cases() {
  const Incidence normal{}, oblique{.theta = 55.0 * std::numbers::pi / 180.0}, diffuse{true};
  return {
      {"slab", LayerStack({of(.2, 3, .8, 1, .7)}), normal},
      {"three layers, ground",
       LayerStack({of(1, 5, .9, 1.4, .1), of(.1, 20, .7, 1.34, .5), of(.4, 2, -.3, 1.5, .3)}, 1,
                  1.6, {.reflectance = .6}),
       oblique},
      {"clear plate", LayerStack({of(.3, 0, 0, 1.5, 1), of(.05, 8, .6, 1.33, .4)}, 1, 1), diffuse},
      {"half-space", LayerStack({of(.5, 4, 0, 1.3, .2), of(.02, 10, .85, 1.4, endless)}, 1, 1.4),
       oblique},
      {"thick", LayerStack({of(1e-4, 30, .5, 1.4, 20)}, 1, 1.4), diffuse},
  };
}

TEST(AddingDoublingDerivatives, AreThoseOfCentralDifferences) {
  for (const auto& [name, stack, incidence] : cases()) {
    const AddingDoublingDerivatives exact = adding_doubling_derivatives(stack, incidence, one_grid);
    ASSERT_EQ(exact.totals.nodes, one_grid.max_nodes);
    for (std::size_t k = 0; k < stack.layers().size(); ++k)
      for (const LayerParameter& parameter : layer_parameters) {
        Layer layer = stack.layers()[k];
        const double value = parameter.value(layer);
        const bool is_g = std::string(parameter.name) == "g";
        if (!std::isfinite(value) || (!is_g && value == 0.0)) continue;
        // A quotient over h and one over 2 h: what is left is of order h^4.
        const double h = is_g ? 2e-3 : 1e-3 * value;
        const auto difference = [&](double step, auto total) {
          const auto at = [&](double by) {
            return total(adding_doubling(changed(stack, k, parameter, by), incidence, one_grid));
          };
          return (at(step) - at(-step)) / (2.0 * step);
        };
        const auto expect = [&](const char* what, double derivative, auto total) {
          const double expected = (4.0 * difference(h, total) - difference(2.0 * h, total)) / 3.0;
          // Rounding of the totals, 1e-13, is what the quotient adds.
          EXPECT_NEAR(derivative, expected, 1e-7 * std::abs(expected) + 3e-13 / h)
              << name << ": " << what << " by " << parameter.name << " of layer " << k;
        };
        using Totals = AddingDoublingTotals;
        expect("R", exact.diffuse_reflectance[k].*parameter.derivative,
               [](const Totals& t) { return t.totals.diffuse_reflectance; });
        expect("T", exact.transmittance[k].*parameter.derivative,
               [](const Totals& t) { return t.totals.transmittance; });
        expect("unscattered T", exact.unscattered_transmittance[k].*parameter.derivative,
               [](const Totals& t) { return t.unscattered_transmittance; });
        expect("unscattered R", exact.unscattered_reflectance[k].*parameter.derivative,
               [](const Totals& t) { return t.unscattered_reflectance; });
      }
  }
}

// One grid is the last of those that refining stops at.
TEST(AddingDoublingDerivatives, OnOneGridAreThoseOfItsTotals) {
  for (const auto& [name, stack, incidence] : cases()) {
    const AddingDoublingDerivatives refined =
        adding_doubling_derivatives(stack, incidence, one_grid);
    const AddingDoublingDerivatives on_grid =
        adding_doubling_derivatives_on_grid(stack, incidence, one_grid.max_nodes);
    const AddingDoublingTotals totals =
        adding_doubling_on_grid(stack, incidence, one_grid.max_nodes);
    EXPECT_EQ(totals.totals.diffuse_reflectance, refined.totals.totals.diffuse_reflectance);
    for (std::size_t k = 0; k < stack.layers().size(); ++k) {
      EXPECT_EQ(on_grid.diffuse_reflectance[k].by_sigma_a,
                refined.diffuse_reflectance[k].by_sigma_a)
          << name;
      EXPECT_EQ(on_grid.transmittance[k].by_g, refined.transmittance[k].by_g) << name;
    }
    // The derivatives come with a second solution of the layers, of other rounding.
    EXPECT_NEAR(on_grid.totals.totals.diffuse_reflectance, totals.totals.diffuse_reflectance,
                1e-10);
    EXPECT_NEAR(on_grid.totals.totals.transmittance, totals.totals.transmittance, 1e-10);
    EXPECT_EQ(on_grid.totals.nodes, one_grid.max_nodes);
    EXPECT_FALSE(on_grid.totals.is_accurate);
  }
}

/// Seen from a layer, light knows optical thicknesses only. And two halves are the whole.
TEST(AddingDoublingDerivatives, ScaleAndSplit) {
  const Layer whole = of(.3, 6, .8, 1.4, .8);
  Layer half = whole;
  half.thickness *= 0.5;
  const auto one = adding_doubling_derivatives(LayerStack({whole}), {.theta = .7});
  const auto two = adding_doubling_derivatives(LayerStack({half, half}), {.theta = .7});
  for (const auto total :
       {&AddingDoublingDerivatives::diffuse_reflectance, &AddingDoublingDerivatives::transmittance,
        &AddingDoublingDerivatives::unscattered_transmittance}) {
    const LayerDerivatives &of_one = (one.*total)[0], &upper = (two.*total)[0],
                           &lower = (two.*total)[1];
    EXPECT_NEAR(.3 * of_one.by_sigma_a + 6 * of_one.by_sigma_s, .8 * of_one.by_thickness, 1e-11);
    EXPECT_NEAR(of_one.by_sigma_a, upper.by_sigma_a + lower.by_sigma_a, 1e-9);
    EXPECT_NEAR(of_one.by_sigma_s, upper.by_sigma_s + lower.by_sigma_s, 1e-9);
    EXPECT_NEAR(of_one.by_g, upper.by_g + lower.by_g, 1e-9);
    EXPECT_NEAR(of_one.by_thickness, upper.by_thickness, 1e-9);
    EXPECT_NEAR(of_one.by_thickness, lower.by_thickness, 1e-9);
  }
}

TEST(AddingDoublingDerivatives, AbsorbingSlabFollowsBeerLambert) {
  const double theta = .5, cos = std::cos(theta), tau = 2 * .6 / cos;
  const auto result =
      adding_doubling_derivatives(LayerStack({of(2, 0, 0, 1, .6)}), {.theta = theta});
  const LayerDerivatives& derivatives = result.transmittance[0];
  EXPECT_NEAR(derivatives.by_sigma_a, -.6 / cos * std::exp(-tau), 1e-13);
  EXPECT_NEAR(derivatives.by_thickness, -2 / cos * std::exp(-tau), 1e-13);
  EXPECT_EQ(derivatives.by_g, 0.0);
  // Isotropic light scattered once by a thin slab: half of it to either side.
  const auto thin = adding_doubling_derivatives(LayerStack({of(1e-9, 0, 0, 1, 1e-3)}));
  EXPECT_NEAR(thin.diffuse_reflectance[0].by_sigma_s, .5e-3, 1e-8);
  EXPECT_NEAR(thin.transmittance[0].by_sigma_s, -.5e-3, 1e-8);
}

/// Towards scattering: against a difference over a small step in a plate that catches light.
TEST(AddingDoublingDerivatives, FirstScatteringInAClearPlate) {
  const auto stack = [](double sigma_s) {
    return LayerStack({of(2, sigma_s, .7, 1.5, .5), of(.1, 5, .5, 1.3, 1)}, 1, 1);
  };
  const auto exact = adding_doubling_derivatives(stack(0), {.theta = .4}, one_grid);
  const auto at = [&](double sigma_s) {
    return adding_doubling(stack(sigma_s), {.theta = .4}, one_grid);
  };
  const auto none = at(0), one = at(1e-4), two = at(2e-4);
  const auto derivative = [](double f0, double f1, double f2) {
    return (4 * f1 - 3 * f0 - f2) / 2e-4;
  };
  EXPECT_NEAR(exact.diffuse_reflectance[0].by_sigma_s,
              derivative(none.totals.diffuse_reflectance, one.totals.diffuse_reflectance,
                         two.totals.diffuse_reflectance),
              1e-8);
  EXPECT_NEAR(
      exact.transmittance[0].by_sigma_s,
      derivative(none.totals.transmittance, one.totals.transmittance, two.totals.transmittance),
      1e-8);
}

TEST(AddingDoublingDerivatives, RefusesWhatHasNone) {
  Layer rough = of(1, 1, 0, 1.4, 1);
  rough.top.roughness = 0.2;
  EXPECT_THROW((void)adding_doubling_derivatives(LayerStack({rough})), InvalidInput);
  EXPECT_THROW((void)adding_doubling_derivatives(LayerStack({of(0, 1, 0, 1, endless)})),
               InvalidInput);
}

}  // namespace
}  // namespace lamina

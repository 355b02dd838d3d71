// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/monte_carlo/cylinder_photons.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lamina/base/core/error.h"
#include "lamina/base/core/quadrature.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"
#include "solve/scattering/monte_carlo/delta_tracking.h"

namespace lamina {
namespace {

void expect_within(const Estimate& estimate, double reference, double largest_error,
                   double standard_errors = 4.0) {
  EXPECT_NEAR(estimate.value, reference, standard_errors * estimate.standard_error);
  EXPECT_LT(estimate.standard_error, largest_error);  // so that noise cannot hide a bias
}

double all_of(const CylinderPhotons& photons) {
  double sum = photons.specular + photons.reflected.value + photons.transmitted.value +
               photons.through_sides.value;
  for (const Estimate& e : photons.absorbed_by_layers) sum += e.value;
  for (const Estimate& e : photons.absorbed_by_cylinders) sum += e.value;
  return sum;
}

const Layer epidermis{.medium = {1.0, 20.0, 0.7, 1.4}, .thickness = 0.1};
const Layer dermis{.medium = {0.3, 15.0, 0.8, 1.38}, .thickness = 1.0};

// Cylinders that are what is around them change nothing, in layers whose boundaries reflect.
TEST(CylinderPhotons, OfWhatIsAroundThemAreThoseOfTheLayers) {
  const LayerStack stack({epidermis, dermis}, 1.0, 1.2);
  const Medium& same = dermis.medium;
  const CylinderPhotons photons =
      trace_cylinder_photons({.stack = stack,
                              .cylinders = {{0.2, 0.35, 0.2, same.sigma_a, same.sigma_s, same.g},
                                            {0.6, 0.6, 0.15, same.sigma_a, same.sigma_s, same.g}},
                              .width = 0.8,
                              .length = 0.3},
                             {.photons = 100'000, .seed = 3});
  const auto wanted = adding_doubling(stack);
  EXPECT_NEAR(photons.specular, wanted.totals.specular_reflectance, 1e-12);
  expect_within(photons.reflected, wanted.totals.diffuse_reflectance, 1.2e-3);
  expect_within(photons.transmitted, wanted.totals.transmittance, 1.2e-3);
  EXPECT_GT(photons.absorbed_by_cylinders[0].value, 0.01);
  EXPECT_NEAR(all_of(photons), 1.0, 2e-3);
}

// Nothing scatters: what a cylinder absorbs is the integral over its chords.
TEST(CylinderPhotons, AbsorbAlongTheirChords) {
  const CylinderPhotons photons = trace_cylinder_photons(
      {.stack = LayerStack({{.medium = {0.0, 0.0, 0.0, 1.0}, .thickness = 1.0}}),
       .cylinders = {{0.45, 0.5, 0.3, 4.0}}},
      {.photons = 50'000, .seed = 4});
  const double wanted =
      integrate([](double x) { return 1.0 - std::exp(-8.0 * std::sqrt(0.09 - x * x)); }, -0.3, 0.3);
  expect_within(photons.absorbed_by_cylinders[0], wanted, 2e-3);
  EXPECT_NEAR(all_of(photons), 1.0, 1e-9);
}

// A vessel under a beam in an open box: photons that know no surfaces find the same.
TEST(CylinderPhotons, AreThoseOfDeltaTracking) {
  const Medium above{1.7, 37.0, 0.9, 1.0}, below{0.05, 35.0, 0.9, 1.0}, blood{23.0, 9.4, 0.9, 1.0};
  const CylinderPhotons photons = trace_cylinder_photons(
      {.stack =
           LayerStack({{.medium = above, .thickness = 0.1}, {.medium = below, .thickness = 0.9}}),
       .cylinders = {{0.5, 0.4, 0.1, blood.sigma_a, blood.sigma_s, blood.g}},
       .sides = BoxSides::open,
       .beam_radius = 0.3},
      {.photons = 40'000, .seed = 5});
  constexpr std::uint64_t count = 40'000;
  const auto wanted = absorbed_by_tissues(
      {1.0, 1.0, 1.0}, 3, 38.7,
      [&](const Vec3& at) {
        if (std::hypot(at.x - 0.5, at.z - 0.4) < 0.1) return Tissue{2, blood};
        return at.z < 0.1 ? Tissue{0, above} : Tissue{1, below};
      },
      [](Random& random) {
        const double r = 0.3 * std::sqrt(random.uniform()), phi = 6.283185307 * random.uniform();
        return Vec3{0.5 + r * std::cos(phi), 0.5 + r * std::sin(phi), 0.0};
      },
      count, 6);
  const auto both = [&](Estimate estimate, double fraction) {
    estimate.standard_error =
        std::hypot(estimate.standard_error, std::sqrt(fraction * (1.0 - fraction) / count));
    expect_within(estimate, fraction, 4e-3);
  };
  both(photons.absorbed_by_layers[0], wanted[0]);
  both(photons.absorbed_by_layers[1], wanted[1]);
  both(photons.absorbed_by_cylinders[0], wanted[2]);
  EXPECT_GT(photons.absorbed_by_cylinders[0].value, 0.03);
  EXPECT_NEAR(all_of(photons), 1.0, 4e-3);
}

TEST(CylinderPhotons, RefuseCylindersThatLeaveTheirLayer) {
  const LayerStack stack({epidermis, dermis});
  const auto trace = [&](const std::vector<Cylinder>& cylinders) {
    (void)trace_cylinder_photons({.stack = stack, .cylinders = cylinders}, {.photons = 1});
  };
  EXPECT_NO_THROW(trace({{0.5, 0.31, 0.2}}));
  EXPECT_THROW(trace({{0.5, 0.29, 0.2}}), InvalidInput);                  // reaches the epidermis
  EXPECT_THROW(trace({{0.1, 0.5, 0.2}}), InvalidInput);                   // and the box's side
  EXPECT_THROW(trace({{0.3, 0.5, 0.2}, {0.6, 0.5, 0.2}}), InvalidInput);  // and another
  EXPECT_THROW(trace({{0.5, 0.5, 0.0}}), InvalidInput);
  // A box that repeats is crossed side by side.
  EXPECT_THROW((void)trace_cylinder_photons({.stack = stack, .length = 5e-324}, {.photons = 1}),
               InvalidInput);
}

}  // namespace
}  // namespace lamina

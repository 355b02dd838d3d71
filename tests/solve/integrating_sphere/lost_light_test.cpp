// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/integrating_sphere/lost_light.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "lamina/base/core/error.h"
#include "lamina/base/core/quadrature.h"
#include "lamina/solve/scattering/spatial_frequency/frequency_response.h"
#include "lamina/solve/scattering/spatial_frequency/frequency_solver.h"

namespace lamina {
namespace {

const LayerStack slab({{.medium = {.sigma_a = 0.02, .sigma_s = 5.0, .g = 0.8, .ior = 1.35},
                        .thickness = 2.0}});

// The same by radiative transfer, wave by wave: a disc of light within a disc, both as waves
// J0(k r), whose responses R(k) make port int R(k) 2 J1(k beam) / (k beam) J1(k port) dk.
TEST(LostLight, IsThatOfRadiativeTransferOverSpatialFrequency) {
  constexpr double port = 4.0;  // radius [mm]
  for (const bool is_diffuse : {false, true}) {
    const double beam = is_diffuse ? port : 1.0;
    const auto solver = detail::make_frequency_solver(slab, 8, 6);
    const Quadrature rule = gauss_legendre(64, 0.0, 1.0);
    std::vector<double> k = {0.0}, weights = {0.0};
    for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
      const double x = rule.nodes[i];
      k.push_back(12.0 * x * x);
      const double b = k.back() * beam;
      weights.push_back(rule.weights[i] * 24.0 * x * port * 2.0 * std::cyl_bessel_j(1, b) / b *
                        std::cyl_bessel_j(1, k.back() * port));
    }
    const auto found =
        is_diffuse ? detail::diffuse_responses(solver, k) : detail::responses(solver, k);
    double reflected = found[0].reflectance, transmitted = found[0].transmittance;
    for (std::size_t i = 1; i < k.size(); ++i) {
      reflected -= weights[i] * found[i].reflectance;
      transmitted -= weights[i] * found[i].transmittance;
    }
    const LostLight lost =
        lost_light(slab, {.is_diffuse = is_diffuse}, 2.0 * beam, 2.0 * port, {.photons = 400'000});
    EXPECT_GT(lost.reflected.value, 0.04);
    EXPECT_LT(lost.reflected.standard_error, 7e-4);
    EXPECT_NEAR(lost.reflected.value, reflected, 3.0 * lost.reflected.standard_error + 5e-4);
    EXPECT_NEAR(lost.transmitted.value, transmitted, 3.0 * lost.transmitted.standard_error + 5e-4);
  }
}

TEST(LostLight, IsNoneBesideWidePortsAndAllBesideNone) {
  EXPECT_LT(lost_light(slab, {}, 2.0, 200.0, {.photons = 20'000}).reflected.value, 1e-4);
  const LostLight all = lost_light(slab, {}, 0.0, 1e-4, {.photons = 20'000});
  EXPECT_NEAR(all.reflected.value, 0.42, 0.03);  // the diffuse reflectance
  EXPECT_THROW((void)lost_light(slab, {}, 3.0, 2.0), InvalidInput);
}

}  // namespace
}  // namespace lamina

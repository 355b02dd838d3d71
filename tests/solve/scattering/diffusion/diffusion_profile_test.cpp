// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/diffusion/diffusion_profile.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <string>

#include "lamina/base/core/error.h"
#include "lamina/base/core/quadrature.h"
#include "lamina/solve/scattering/diffusion/dipole.h"
#include "literal/diffusion_skin.h"

namespace lamina {
namespace {

using reference::donner_jensen_skin;
using std::numbers::pi;
constexpr double infinite = std::numeric_limits<double>::infinity();

/// The inverse Hankel transform by brute force: Gauss-Legendre panels, each shorter than a period
/// of J0 and than the scale of the spectrum near k, up to where the spectrum has vanished.
double by_quadrature(const std::function<double(double)>& spectrum, double r, double last_k) {
  static const Quadrature rule = gauss_legendre(12, 0.0, 1.0);
  double sum = 0.0;
  for (double k = 0.0; k < last_k;) {
    const double step = std::min(3.0 / r, 0.02 + 0.25 * k);
    for (std::size_t q = 0; q < rule.nodes.size(); ++q) {
      const double at = k + step * rule.nodes[q];
      sum += step * rule.weights[q] * at * ::j0(at * r) * spectrum(at);
    }
    k += step;
  }
  return sum / (2.0 * pi);
}

TEST(DiffusionProfile, LayeredSkinAgreesWithConvergedQuadrature) {
  const std::vector<LayerStack> skin = donner_jensen_skin();
  const Profile profile = make_diffusion_profile(skin).profile;
  double worst = 0.0;
  int compared = 0;
  for (std::size_t b = 0; b < 3; ++b) {
    const LayeredDiffusion model = make_layered_diffusion(skin[b]);
    const auto R = [&](double k) { return response(model, k).reflection_above; };
    const double peak = profile.reflectance_at(0, b);
    for (std::size_t i = 0; i < profile.r.size(); i += 17) {
      if (profile.reflectance_at(i, b) < 1e-8 * peak) continue;
      const double exact = by_quadrature(R, profile.r[i], 40.0 / model.layers[0].source_depth);
      worst = std::max(worst, std::abs(profile.reflectance_at(i, b) / exact - 1.0));
      ++compared;
    }
  }
  EXPECT_GT(compared, 30);
  EXPECT_LT(worst, 1e-6);  // the quadrature itself is good to 1e-7 of a profile's 1e-8th part
}

TEST(DiffusionProfile, FiniteLayersAgreeWithConvergedQuadratureInTransmission) {
  const std::vector<LayerStack> stacks = {
      LayerStack({{.medium = {.sigma_a = 0.1, .sigma_s = 10.0, .ior = 1.4}, .thickness = 0.4},
                  {.medium = {.sigma_a = 0.01, .sigma_s = 2.0, .ior = 1.3}, .thickness = 1.5}})};
  const Profile profile = make_diffusion_profile(stacks).profile;
  const LayeredDiffusion model = make_layered_diffusion(stacks[0]);
  for (std::size_t i = 3; i < 200; i += 13) {
    const double r = profile.r[i];
    const double R =
        by_quadrature([&](double k) { return response(model, k).reflection_above; }, r, 400.0);
    const double T =
        by_quadrature([&](double k) { return response(model, k).transmission_down; }, r, 400.0);
    if (R > 1e-8 * profile.reflectance_at(0, 0)) {
      EXPECT_NEAR(profile.reflectance_at(i, 0), R, 1e-6 * R) << r;
    }
    if (T > 1e-8 * profile.transmittance_at(0, 0)) {
      EXPECT_NEAR(profile.transmittance_at(i, 0), T, 1e-6 * T) << r;
    }
  }
}

// The image sources in space, [DonnerJensen2005] Eqs. 12 and 13 with distances to the bottom.
TEST(DiffusionProfile, SlabIsTheSumOfItsImagesInSpace) {
  const Medium medium = {.sigma_a = 0.02, .sigma_s = 1.0};
  const double d = 2.0, l = mfp_prime(medium), b = 2.0 / 3.0 * l, tr = sigma_tr(medium);
  const Profile profile =
      make_diffusion_profile(std::vector{LayerStack({{.medium = medium, .thickness = d}})}).profile;
  for (std::size_t i = 0; i < profile.r.size(); i += 9) {
    const double r = profile.r[i];
    const auto flux = [&](double z) {
      const double distance = std::hypot(r, z);
      return z * (1.0 + tr * distance) * std::exp(-tr * distance) /
             (4.0 * pi * distance * distance * distance);
    };
    double R = 0.0, T = 0.0;
    for (int n = -60; n <= 60; ++n) {
      const double z_r = 2.0 * n * (d + 2.0 * b) + l, z_v = 2.0 * n * (d + 2.0 * b) - l - 2.0 * b;
      R += albedo_prime(medium) * (flux(z_r) - flux(z_v));
      T += albedo_prime(medium) * (flux(d - z_r) - flux(d - z_v));
    }
    if (R > 1e-8 * profile.reflectance_at(0, 0)) {
      EXPECT_NEAR(profile.reflectance_at(i, 0), R, 1e-6 * R) << r;
    }
    if (T > 1e-8 * profile.transmittance_at(0, 0)) {
      EXPECT_NEAR(profile.transmittance_at(i, 0), T, 1e-6 * T) << r;
    }
  }
}

TEST(DiffusionProfile, KeepsTheEnergy) {
  std::vector<LayerStack> stacks = donner_jensen_skin();
  // A half-space without absorption: beyond 100 mm remains a part that the analytic tail holds.
  stacks.push_back(LayerStack({{.medium = {.sigma_s = 1.0}}}));
  stacks.push_back(LayerStack({{.medium = {.sigma_s = 5.0, .ior = 1.4}, .thickness = 3.0}}));
  stacks.push_back(LayerStack({{.medium = {.sigma_a = 9.0, .sigma_s = 1.0, .ior = 1.4}}}));
  const Profile profile = make_diffusion_profile(stacks).profile;
  for (std::size_t b = 0; b < stacks.size(); ++b) {
    const FluxCurve reflected = reflected_flux(profile, b), passed = transmitted_flux(profile, b);
    EXPECT_NEAR(reflected.within.back() + reflected.beyond, profile.total_reflectance[b],
                1e-4 * profile.total_reflectance[b])
        << "band " << b;
    EXPECT_NEAR(passed.within.back() + passed.beyond, profile.total_transmittance[b],
                1e-4 * profile.total_transmittance[b])
        << "band " << b;
  }
  const FluxCurve half_space = reflected_flux(profile, 3);
  // l + z_b = 5/3 l over the radius; the next term of the tail is some (3 l / r)^2 of it.
  EXPECT_NEAR(half_space.beyond, 5.0 / 3.0 / 100.0, 1e-3 * 5.0 / 3.0 / 100.0);
}

TEST(DiffusionProfile, ThinLayersAreFlaggedAndKeepTheEnergy) {
  const std::vector<LayerStack> leaf = {
      LayerStack({{.medium = {.sigma_a = 0.1, .sigma_s = 2.0, .ior = 1.4}, .thickness = 0.3}}),
      LayerStack({{.medium = {.sigma_a = 0.1, .sigma_s = 9.0, .ior = 1.4}, .thickness = 0.3}})};
  const DiffusionProfile result = make_diffusion_profile(leaf);
  EXPECT_EQ(result.thin_layers[0], std::vector<std::size_t>{0});
  EXPECT_TRUE(result.thin_layers[1].empty());
  const Profile& profile = result.profile;
  const LayerResponse local = local_response(make_layered_diffusion(leaf[0]));
  const FluxCurve R = reflected_flux(profile, 0), T = transmitted_flux(profile, 0);
  EXPECT_NEAR(R.within.back() + R.beyond, profile.total_reflectance[0], 1e-4);
  EXPECT_GT(local.transmission_down, 0.5);
  EXPECT_NEAR(T.within.back() + T.beyond + local.transmission_down, profile.total_transmittance[0],
              1e-4);
}

TEST(DiffusionProfile, FallsOffSmoothlyFarBelowRoundingErrors) {
  const Profile profile = make_diffusion_profile(donner_jensen_skin()).profile;
  for (std::size_t b = 0; b < 3; ++b)
    for (std::size_t i = 1; i < profile.r.size(); ++i) {
      EXPECT_LE(profile.reflectance_at(i, b), profile.reflectance_at(i - 1, b));
      EXPECT_GE(profile.reflectance_at(i, b), 0.0);
      EXPECT_EQ(profile.transmittance_at(i, b), 0.0);
    }
  // Blue light has gone at 10 mm, where rounding errors of the peak are 1e17 times larger.
  const Dipole deep = make_dipole(donner_jensen_skin()[2].layers()[2].medium, 1.4);
  const std::size_t i = 200;
  EXPECT_LT(profile.reflectance_at(i, 2), 1e-20 * profile.reflectance_at(0, 2));
  EXPECT_GT(deep.sigma_tr * profile.r[i], 60.0);
}

TEST(DiffusionProfile, IsTheSameAtFewRadii) {
  const std::vector<LayerStack> skin = donner_jensen_skin();
  const Profile all = make_diffusion_profile(skin, {}, {.size = 256}).profile,
                few = make_diffusion_profile(skin, {}, {.size = 6}).profile;
  ASSERT_EQ(few.r.size(), 6u);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_DOUBLE_EQ(few.r[i], all.r[51 * i]);
    for (std::size_t b = 0; b < 3; ++b) {
      const double expected = all.reflectance_at(51 * i, b);
      if (expected > 1e-8 * all.reflectance_at(0, b)) {
        EXPECT_NEAR(few.reflectance_at(i, b), expected, 1e-5 * expected) << i;
      } else {
        EXPECT_LT(few.reflectance_at(i, b), 1e-8 * all.reflectance_at(0, b)) << i;
      }
    }
  }
}

TEST(DiffusionProfile, ErrorsNameBandAndLayer) {
  const LayerStack good({{.medium = {.sigma_s = 1.0}}}), bad({{.medium = {.sigma_a = 1.0}}});
  try {
    (void)make_diffusion_profile(std::vector{good, bad});
    FAIL();
  } catch (const InvalidInput& error) {
    EXPECT_STREQ(error.what(), "band 1: layer 0: diffusion requires sigma_s > 0 [1/mm], but is 0");
  }
  EXPECT_THROW((void)make_diffusion_profile({}), InvalidInput);
}

TEST(DiffusionProfile, OfManyBandsIsThatOfEach) {
  std::vector<LayerStack> stacks;
  for (int b = 0; b < 70; ++b)  // more than are solved at once
    stacks.push_back(
        LayerStack({{.medium = {.sigma_a = 0.01 + 0.001 * b, .sigma_s = 10.0, .g = 0.8, .ior = 1.4},
                     .thickness = 0.1 + 0.05 * b}}));
  const DiffusionProfile all = make_diffusion_profile(stacks, {}, {.size = 16});
  ASSERT_EQ(all.profile.bands, stacks.size());
  for (const std::size_t b : {std::size_t{0}, std::size_t{31}, std::size_t{32}, std::size_t{69}}) {
    const DiffusionProfile one = make_diffusion_profile({&stacks[b], 1}, {}, {.size = 16});
    EXPECT_DOUBLE_EQ(all.profile.total_reflectance[b], one.profile.total_reflectance[0]);
    EXPECT_DOUBLE_EQ(all.profile.total_transmittance[b], one.profile.total_transmittance[0]);
    EXPECT_DOUBLE_EQ(all.clamped_reflectance[b], one.clamped_reflectance[0]);
    EXPECT_EQ(all.thin_layers[b], one.thin_layers[0]);
    for (std::size_t i = 0; i < one.profile.r.size(); ++i) {
      const std::size_t at = i * stacks.size() + b;
      EXPECT_NEAR(all.profile.reflectance_profile[at] / one.profile.reflectance_profile[i], 1.0,
                  1e-9);
      EXPECT_NEAR(all.profile.transmittance_profile[at] / one.profile.transmittance_profile[i], 1.0,
                  1e-9);
    }
  }
}

}  // namespace
}  // namespace lamina

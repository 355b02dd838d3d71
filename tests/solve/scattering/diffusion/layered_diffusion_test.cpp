// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/diffusion/layered_diffusion.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <numeric>
#include <string>

#include "lamina/base/core/error.h"
#include "lamina/base/core/random.h"
#include "lamina/layers/optics/fresnel.h"
#include "lamina/layers/optics/rough/rough_interface.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"
#include "literal/diffusion_skin.h"

namespace lamina {
namespace {

using reference::donner_jensen_skin;
constexpr double infinite = std::numeric_limits<double>::infinity();

std::string message_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "";
}

// [DonnerJensen2005] Table 3. Digits from an independent program for these equations.
TEST(LayeredDiffusion, GivesTheTotalsOfTheSkinOfTable3) {
  const double polynomial[] = {.40836, .39855, .33265}, exact[] = {.40861, .39882, .33281};
  for (std::size_t band = 0; band < 3; ++band) {
    const LayerStack skin = donner_jensen_skin()[band];
    const auto total = [&](DiffuseFresnel fresnel) {
      return response(make_layered_diffusion(skin, {.fresnel = fresnel}), 0.0).reflection_above;
    };
    EXPECT_NEAR(total(DiffuseFresnel::polynomial), polynomial[band], 1e-5);
    EXPECT_NEAR(total(DiffuseFresnel::exact), exact[band], 1e-5);
  }
}

/// An epidermis over a dermis in red light, index-matched within a percent.
LayerStack skin_of_epidermis(double thickness) {
  return LayerStack(
      {{.medium = {.sigma_a = 0.35, .sigma_s = 17.0, .g = 0.8, .ior = 1.4}, .thickness = thickness},
       {.medium = {.sigma_a = 0.03, .sigma_s = 8.5, .g = 0.8, .ior = 1.38}, .thickness = infinite}},
      1.0, 1.38);
}

// The epidermis is as thick as its source is deep at .267 mm.
TEST(LayeredDiffusion, ReflectanceFollowsTheThicknessOfTheEpidermisWithoutJumps) {
  const auto by_diffusion = [](double thickness) {
    return diffusion_totals(skin_of_epidermis(thickness), {}).diffuse_reflectance;
  };
  for (double thickness = 0.005; thickness < 0.6; thickness *= 1.01) {
    const double value = by_diffusion(thickness);
    EXPECT_NEAR(by_diffusion(1.01 * thickness), value, 0.006 * value) << thickness;
  }
  for (const double thickness : {0.005, 0.02, 0.08, 0.2, 0.26, 0.28, 0.4}) {
    const double truth = adding_doubling(skin_of_epidermis(thickness)).totals.diffuse_reflectance;
    const double value = by_diffusion(thickness);
    EXPECT_NEAR(value, truth, 0.13 * truth) << "thickness " << thickness;
  }
}

/// The reflections between two layers, one after the other, as [DonnerJensen2005] Eq. 19 has them.
TEST(LayeredDiffusion, StackedLayersAreTheSeriesOfTheirReflections) {
  const LayerResponse a = {0.3, 0.6, 0.5, 0.4}, b = {0.7, 0.2, 0.1, 0.25};
  double down = 1.0, reflection = a.reflection_above, transmission = 0.0, up_out = 0.0;
  for (int n = 0; n < 200; ++n) {
    transmission += a.transmission_down * down * b.transmission_down;
    reflection += a.transmission_down * down * b.reflection_above * a.transmission_up;
    up_out += b.transmission_up * down * a.transmission_up;
    down *= b.reflection_above * a.reflection_below;
  }
  const LayerResponse both = stacked(a, b);
  EXPECT_NEAR(both.transmission_down, transmission, 1e-15);
  EXPECT_NEAR(both.reflection_above, reflection, 1e-15);
  EXPECT_NEAR(both.transmission_up, up_out, 1e-15);
}

// [DonnerJensen2005] Eqs. 17 and 18: the first term of the series above.
TEST(LayeredDiffusion, WithoutInterreflectionsLightTurnsRoundOnce) {
  const LayerResponse upper{.3, .5, .4, .6}, lower{.2, .7, .1, .8};
  const LayerResponse once = stacked(upper, lower, Interreflections::none);
  EXPECT_DOUBLE_EQ(once.reflection_above, .3 + .5 * .2 * .6);
  EXPECT_DOUBLE_EQ(once.transmission_down, .5 * .7);
  EXPECT_DOUBLE_EQ(once.reflection_below, .1 + .8 * .4 * .7);
  EXPECT_DOUBLE_EQ(once.transmission_up, .8 * .6);

  const LayerStack plates(
      {{.medium = {.sigma_a = 0.05, .sigma_s = 9.0, .ior = 1.4}, .thickness = 0.4},
       {.medium = {.sigma_a = 0.02, .sigma_s = 4.0, .ior = 1.5}, .thickness = 0.8}});
  const SlabTotals all = diffusion_totals(plates, {}),
                   few = diffusion_totals(plates, {}, {.interreflections = Interreflections::none});
  EXPECT_LT(few.diffuse_reflectance, all.diffuse_reflectance - 0.01);
  EXPECT_LT(few.transmittance, all.transmittance - 0.01);
  const LayeredDiffusion model = make_layered_diffusion(plates);
  const LayerResponse first = response(model.layers[0], 0.0),
                      second = response(model.layers[1], 0.0);
  EXPECT_NEAR(few.diffuse_reflectance,
              (1.0 - few.specular_reflectance) *
                  (first.reflection_above +
                   first.transmission_down * second.reflection_above * first.transmission_up),
              1e-14);
}

TEST(LayeredDiffusion, OrderOfStackingDoesNotMatter) {
  const LayerResponse a = {0.3, 0.6, 0.5, 0.4}, b = {0.7, 0.2, 0.1, 0.25}, c = {0.2, 0.7, 0.4, 0.3};
  const LayerResponse x = stacked(stacked(a, b), c), y = stacked(a, stacked(b, c));
  EXPECT_NEAR(x.reflection_above, y.reflection_above, 1e-15);
  EXPECT_NEAR(x.transmission_down, y.transmission_down, 1e-15);
  EXPECT_NEAR(x.reflection_below, y.reflection_below, 1e-15);
  EXPECT_NEAR(x.transmission_up, y.transmission_up, 1e-15);
  const LayerResponse alone = stacked({}, stacked(a, {}));  // nothing above and below
  EXPECT_DOUBLE_EQ(alone.reflection_above, a.reflection_above);
  EXPECT_DOUBLE_EQ(alone.transmission_up, a.transmission_up);
}

TEST(LayeredDiffusion, TurnedStackExchangesAboveAndBelow) {
  const LayerStack stack(
      {{.medium = {.sigma_a = 0.1, .sigma_s = 20.0, .ior = 1.4}, .thickness = 0.3},
       {.medium = {.sigma_a = 0.02, .sigma_s = 9.0, .ior = 1.3}, .thickness = 0.5}},
      1.0, 1.2);
  for (const double k : {0.0, 0.7, 9.0}) {
    const LayerResponse lit = response(make_layered_diffusion(stack), k);
    const LayerResponse turned = response(make_layered_diffusion(flipped(stack)), k);
    EXPECT_NEAR(lit.reflection_above, turned.reflection_below, 1e-14);
    EXPECT_NEAR(lit.reflection_below, turned.reflection_above, 1e-14);
    EXPECT_NEAR(lit.transmission_down, turned.transmission_up, 1e-14);
    EXPECT_NEAR(lit.transmission_up, turned.transmission_down, 1e-14);
  }
}

// Reciprocity: what passes down passes up if both boundaries are alike.
TEST(LayeredDiffusion, SymmetricStackTransmitsAlikeBothWays) {
  const Layer outer = {.medium = {.sigma_a = 0.1, .sigma_s = 30.0, .ior = 1.4}, .thickness = 0.2};
  const Layer inner = {.medium = {.sigma_a = 0.5, .sigma_s = 9.0, .ior = 1.3}, .thickness = 0.4};
  const LayeredDiffusion model = make_layered_diffusion(LayerStack({outer, inner, outer}));
  for (const double k : {0.0, 1.0, 10.0}) {
    const LayerResponse at_k = response(model, k);
    EXPECT_NEAR(at_k.transmission_down, at_k.transmission_up, 1e-15);
    EXPECT_NEAR(at_k.reflection_above, at_k.reflection_below, 1e-15);
  }
}

// The layers' model is no exact one: each starts diffusion anew. Two halves of a layer, indices
// matched between them, come near the whole while they are many free paths thick.
TEST(LayeredDiffusion, HalvesOfAThickLayerComeNearTheWhole) {
  const auto layer = [](double thickness) {
    return Layer{.medium = {.sigma_a = 0.01, .sigma_s = 10.0, .ior = 1.4}, .thickness = thickness};
  };
  const LayerResponse whole = response(make_layered_diffusion(LayerStack({layer(4.0)})), 0.0);
  const LayerResponse halves =
      response(make_layered_diffusion(LayerStack({layer(2.0), layer(2.0)})), 0.0);
  EXPECT_NEAR(halves.reflection_above, whole.reflection_above, 0.02 * whole.reflection_above);
  EXPECT_NEAR(halves.transmission_down, whole.transmission_down, 0.05 * whole.transmission_down);
}

TEST(LayeredDiffusion, ClearLayerIsRefusedByName) {
  const Layer clear = {.medium = {.sigma_a = 0.1}, .thickness = 1.0};
  const Layer cloudy = {.medium = {.sigma_s = 3.0}, .thickness = 1.0};
  EXPECT_EQ(message_of([&] {
              (void)make_layered_diffusion(LayerStack({cloudy, clear}));
            }),
            "layer 1: diffusion requires sigma_s > 0 [1/mm], but is 0");
}

TEST(LayeredDiffusion, TotalsAddUpToTheArrivingLight) {
  for (const LayerStack& skin : donner_jensen_skin())
    for (const Incidence incidence : {Incidence{}, Incidence{.theta = 1.2}, Incidence{true, 0.0}}) {
      const SlabTotals totals = diffusion_totals(skin, incidence);
      const double absorbed =
          std::accumulate(totals.absorptance.begin(), totals.absorptance.end(), 0.0);
      EXPECT_NEAR(totals.specular_reflectance + totals.diffuse_reflectance + totals.transmittance +
                      absorbed,
                  1.0, 1e-14);
      EXPECT_GT(totals.absorptance[2], totals.absorptance[1]);  // blood absorbs most
      EXPECT_EQ(totals.transmittance, 0.0);
    }
  const double f = fresnel(1.0, 1.4);
  EXPECT_NEAR(diffusion_totals(donner_jensen_skin()[0], {}).diffuse_reflectance, (1.0 - f) * .40861,
              1e-5);
  EXPECT_DOUBLE_EQ(diffusion_totals(donner_jensen_skin()[0], {true}).specular_reflectance,
                   fresnel_diffuse(1.4));
}

TEST(LayeredDiffusion, LayerWithoutAbsorptionTakesNothing) {
  const LayerStack stack(
      {{.medium = {.sigma_s = 20.0, .ior = 1.4}, .thickness = 0.3},
       {.medium = {.sigma_a = 0.5, .sigma_s = 9.0, .ior = 1.3}, .thickness = 0.5},
       {.medium = {.sigma_s = 15.0, .ior = 1.5}, .thickness = 0.4}});
  const SlabTotals totals = diffusion_totals(stack, {});
  EXPECT_NEAR(totals.absorptance[0], 0.0, 1e-15);
  EXPECT_GT(totals.absorptance[1], 0.01);
  EXPECT_NEAR(totals.absorptance[2], 0.0, 1e-15);
}

TEST(LayeredDiffusion, GroundSendsBackWhatItReflects) {
  const Layer paper = {.medium = {.sigma_s = 30.0, .ior = 1.5}, .thickness = 0.1};
  const auto on = [&](double reflectance) {
    return diffusion_totals(LayerStack({paper}, 1.0, 1.0, {.reflectance = reflectance}), {});
  };
  const SlabTotals on_white = on(1.0), on_grey = on(0.5), on_air = on(0.0);
  EXPECT_NEAR(on_white.diffuse_reflectance, 1.0 - on_white.specular_reflectance, 1e-14);
  EXPECT_NEAR(on_white.transmittance, 0.0, 1e-14);
  EXPECT_GT(on_air.transmittance, on_grey.transmittance);
  EXPECT_GT(on_white.diffuse_reflectance, on_grey.diffuse_reflectance);
  EXPECT_GT(on_grey.diffuse_reflectance, on_air.diffuse_reflectance);
  // Kubelka's formula for a layer on a ground, with interreflections between ground and boundary.
  const LayerResponse r = response(make_layered_diffusion(LayerStack({paper})), 0.0);
  const double f = fresnel_diffuse(1.5), rho = 0.5 * (1.0 - f) / (1.0 - 0.5 * f);
  const double entered = 1.0 - on_grey.specular_reflectance;
  EXPECT_NEAR(on_grey.diffuse_reflectance,
              entered * (r.reflection_above + r.transmission_down * rho * r.transmission_up /
                                                  (1.0 - rho * r.reflection_below)),
              1e-14);
}

/// rho_d of [DonnerJensen2005] §2.4 as its authors get it: the BRDF for random diffuse light.
double rho_d_by_monte_carlo(double roughness, double eta, int samples) {
  const RoughInterface<double> surface = {.facets = {.alpha = roughness}, .eta = eta};
  Random random = make_random(1, 0);
  const auto cosine_weighted = [&] {
    const double sin2 = random.uniform(), phi = 2.0 * std::numbers::pi * random.uniform();
    const double sine = std::sqrt(sin2);
    return Vec3{sine * std::cos(phi), sine * std::sin(phi), std::sqrt(1.0 - sin2)};
  };
  double sum = 0.0;
  for (int i = 0; i < samples; ++i) {
    const Vec3 wi = cosine_weighted(), wo = cosine_weighted();
    sum += std::numbers::pi * torrance_sparrow_brdf(surface, wi, wo);
  }
  return sum / samples;
}

// Light from inside, total reflection included.
TEST(LayeredDiffusion, RoughTopKeepsAboutHalfOfTheLightInside) {
  const Interface rough = {.roughness = 0.3};
  EXPECT_NEAR(diffuse_reflectance_inside({.roughness = 0.05}, 1.4, 1.0, DiffuseFresnel::exact),
              0.53, 0.01);
  // The standard error of the random estimate is .002.
  EXPECT_NEAR(diffuse_reflectance_inside(rough, 1.4, 1.0, DiffuseFresnel::polynomial),
              rho_d_by_monte_carlo(0.3, 1.0 / 1.4, 1'000'000), 0.008);
  EXPECT_EQ(diffuse_reflectance_inside(rough, 1.4, 1.4, DiffuseFresnel::exact), 0.0);
  // Barely rough is as smooth.
  EXPECT_NEAR(diffuse_reflectance_inside({.roughness = 0.01}, 1.4, 1.0, DiffuseFresnel::exact),
              fresnel_diffuse(1.0 / 1.4), 2e-3);
  const Medium medium = {.sigma_a = 0.1, .sigma_s = 5.0, .ior = 1.4};
  const SlabTotals totals =
      diffusion_totals(LayerStack({{.medium = medium, .top = rough}}), {.theta = 1.4});
  const SlabTotals smooth = diffusion_totals(LayerStack({{.medium = medium}}), {.theta = 1.4});
  EXPECT_NEAR(totals.specular_reflectance + totals.diffuse_reflectance + totals.absorptance[0], 1.0,
              1e-14);
  EXPECT_NE(totals.specular_reflectance, smooth.specular_reflectance);
}

RC_GTEST_PROP(LayeredDiffusionLaw, EachLayerTakesItsShareAndNoneIsLost, ()) {
  const auto log_uniform = [](int from, int to) {  // 10^from to 10^to
    return std::pow(10.0, *rc::gen::inRange(100 * from, 100 * to + 1) / 100.0);
  };
  std::vector<Layer> layers;
  const int n = *rc::gen::inRange(1, 6);
  for (int i = 0; i < n; ++i)
    layers.push_back({.medium = {.sigma_a = log_uniform(-4, 1),
                                 .sigma_s = log_uniform(-1, 2),
                                 .g = 0.01 * *rc::gen::inRange(-50, 95),
                                 .ior = 1.0 + 0.01 * *rc::gen::inRange(0, 80)},
                      .thickness = i + 1 == n ? infinite : log_uniform(-3, 1)});
  const SlabTotals totals = diffusion_totals(LayerStack(layers), {});
  double sum = totals.specular_reflectance + totals.diffuse_reflectance;
  for (const double a : totals.absorptance) {
    RC_ASSERT(a >= 0.0);
    sum += a;
  }
  RC_ASSERT(std::abs(sum - 1.0) < 1e-12);
}

}  // namespace
}  // namespace lamina

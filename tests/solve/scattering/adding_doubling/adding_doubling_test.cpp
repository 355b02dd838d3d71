// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <ostream>

#include "lamina/base/core/error.h"
#include "lamina/base/core/quadrature.h"
#include "lamina/layers/optics/fresnel.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling_stack.h"
#include "literal/h_function.h"
#include "literal/stack_table.h"

namespace lamina {

namespace reference {
void PrintTo(const StackCase& entry, std::ostream* out) { *out << entry.name; }
}  // namespace reference

namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr Incidence diffuse{.is_diffuse = true};

Incidence oblique(double degrees) { return {.theta = degrees * std::numbers::pi / 180.0}; }

double sum(const SlabTotals& totals) {
  return totals.specular_reflectance + totals.diffuse_reflectance + totals.transmittance +
         std::accumulate(totals.absorptance.begin(), totals.absorptance.end(), 0.0);
}

Layer layer(double sigma_a, double sigma_s, double g, double ior, double thickness) {
  return {.medium = {.sigma_a = sigma_a, .sigma_s = sigma_s, .g = g, .ior = ior},
          .thickness = thickness};
}

const AddingDoublingOptions fine{.accuracy = 1e-8};

// [VanDeHulst1980] Table 35, more digits by two other programs.
TEST(AddingDoubling, MatchedSlabAgreesWithVanDeHulst) {
  const auto result = adding_doubling(LayerStack({layer(1.0, 9.0, 0.75, 1.0, 0.2)}), {}, fine);
  EXPECT_TRUE(result.is_accurate);
  EXPECT_NEAR(result.totals.diffuse_reflectance, 0.0973946, 1e-7);
  EXPECT_NEAR(result.totals.transmittance, 0.6609577, 1e-7);
  EXPECT_NEAR(result.unscattered_transmittance, std::exp(-2.0), 1e-12);
  EXPECT_EQ(result.totals.specular_reflectance, 0.0);
}

// [Giovanelli1955], more digits by two other programs.
TEST(AddingDoubling, MismatchedHalfSpaceAgreesWithGiovanelli) {
  const auto totals =
      adding_doubling(LayerStack({layer(1.0, 9.0, 0.0, 1.5, infinite)}, 1.0, 1.5), {}, fine).totals;
  EXPECT_NEAR(totals.specular_reflectance, 0.04, 1e-12);
  EXPECT_NEAR(totals.diffuse_reflectance, 0.2199186, 1e-7);
  EXPECT_EQ(totals.transmittance, 0.0);
}

// The three-layer skin of [DonnerJensen2005] Table 3; digits of an independent program.
TEST(AddingDoubling, SkinOfThreeLayers) {
  const auto skin = [](double a1, double s1, double a2, double s2, double a3, double s3) {
    return LayerStack({layer(a1, s1, 0.0, 1.4, 0.03), layer(a2, s2, 0.25, 1.34, 0.05),
                       layer(a3, s3, 0.8, 1.4, infinite)},
                      1.0, 1.4);
  };
  const std::vector<LayerStack> bands = {skin(2.1, 48.0, 0.16, 32.0, 0.085, 4.5),
                                         skin(2.1, 60.0, 0.19, 40.0, 1.0, 4.7),
                                         skin(5.0, 65.0, 0.30, 46.0, 25.0, 4.8)};
  const auto results = adding_doubling(bands);
  const double expected[] = {0.398083, 0.392509, 0.309059};
  for (std::size_t band = 0; band < 3; ++band) {
    EXPECT_NEAR(results[band].totals.diffuse_reflectance, expected[band], 1e-5);
    EXPECT_NEAR(results[band].totals.specular_reflectance, 0.0277778, 1e-7);
  }
}

TEST(AddingDoubling, IsotropicHalfSpaceFollowsChandrasekhar) {
  for (const double albedo : {0.2, 0.8, 0.99})
    for (const double degrees : {0.0, 40.0, 75.0, 88.0}) {
      const LayerStack half_space({layer(1.0 - albedo, albedo, 0.0, 1.0, infinite)});
      const auto totals = adding_doubling(half_space, oblique(degrees), fine).totals;
      const double mu = std::cos(degrees * std::numbers::pi / 180.0);
      EXPECT_NEAR(totals.diffuse_reflectance,
                  1.0 - std::sqrt(1.0 - albedo) * reference::h_function(albedo, mu), 2e-7)
          << "albedo " << albedo << ", " << degrees << " degrees";
    }
}

class StackTable : public testing::TestWithParam<reference::StackCase> {};

TEST_P(StackTable, KeepsItsEnergy) {
  for (const Incidence& incidence : {Incidence{}, oblique(60.0), diffuse}) {
    const auto result = adding_doubling(GetParam().stack, incidence, {.accuracy = 1e-3});
    EXPECT_NEAR(sum(result.totals), 1.0, 1e-10);
    for (std::size_t k = 0; k < result.totals.absorptance.size(); ++k) {
      // Differences of net fluxes: what a layer that absorbs nothing keeps is rounding.
      const bool absorbs = GetParam().stack.layers()[k].medium.sigma_a > 0.0;
      EXPECT_GE(result.totals.absorptance[k], -1e-10);
      if (!absorbs) {
        EXPECT_NEAR(result.totals.absorptance[k], 0.0, 1e-10);
      }
    }
    EXPECT_GE(result.totals.diffuse_reflectance, 0.0);
    EXPECT_GE(result.totals.transmittance, result.unscattered_transmittance - 1e-10);
  }
}

TEST_P(StackTable, StaysWithinTheAccuracyAsked) {
  for (const Incidence& incidence : {Incidence{}, oblique(60.0)}) {
    const auto exact =
        adding_doubling(GetParam().stack, incidence, {.accuracy = 1e-8, .max_nodes = 200});
    ASSERT_TRUE(exact.is_accurate) << exact.estimated_error;
    for (const double accuracy : {1e-2, 1e-3, 1e-5}) {
      const auto result = adding_doubling(GetParam().stack, incidence, {.accuracy = accuracy});
      EXPECT_TRUE(result.is_accurate);
      EXPECT_NEAR(result.totals.diffuse_reflectance, exact.totals.diffuse_reflectance, accuracy);
      EXPECT_NEAR(result.totals.transmittance, exact.totals.transmittance, accuracy);
      for (std::size_t k = 0; k < exact.totals.absorptance.size(); ++k)
        EXPECT_NEAR(result.totals.absorptance[k], exact.totals.absorptance[k], accuracy);
    }
  }
}

// In units of flux over the square root of etendue, reciprocity is symmetry.
TEST_P(StackTable, ReflectsReciprocally) {
  const detail::GridStack stack = detail::make_grid_stack(GetParam().stack, 10, {});
  for (const int m : {0, 1, 2}) {
    const detail::Matrix reflection = detail::stack_operators(stack, m).reflection;
    for (std::size_t i = 0; i < reflection.rows; ++i)
      for (std::size_t j = 0; j < i; ++j)
        EXPECT_NEAR(reflection(i, j), reflection(j, i), 1e-12) << "mode " << m;
  }
}

// Equal etendue carries equal flux both ways: n^2 T is the same from above and from below.
TEST_P(StackTable, TransmitsReciprocally) {
  const LayerStack& stack = GetParam().stack;
  if (is_semi_infinite(stack)) GTEST_SKIP() << "nothing is transmitted";
  const AddingDoublingOptions options{.accuracy = 1e-10, .max_nodes = 16};  // one grid for both
  const double down = adding_doubling(stack, diffuse, options).totals.transmittance;
  const double up = adding_doubling(flipped(stack), diffuse, options).totals.transmittance;
  const double above = stack.ior_above(), below = stack.ior_below();
  EXPECT_NEAR(above * above * down, below * below * up, 1e-10);  // exact on any grid
}

INSTANTIATE_TEST_SUITE_P(All, StackTable, testing::ValuesIn(reference::stack_table()),
                         [](const auto& instance) {
                           std::string name = instance.param.name;
                           for (char& c : name)
                             if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
                           return name;
                         });

// Peaks that 96 nodes do not see either; 200 nodes stand for the truth.
TEST(AddingDoubling, EstimatesHoldForSharpForwardPeaks) {
  struct Case {
    double g, optical_thickness, accuracy;
  };
  for (const auto& [g, tau, accuracy] : {Case{0.98, 0.5, 1e-6},
                                         {0.99, 0.5, 1e-5},
                                         {0.99, 5.0, 1e-6},
                                         {0.995, 5.0, 1e-2},
                                         {0.995, 5.0, 1e-6},
                                         {0.995, 50.0, 1e-6}}) {
    const LayerStack stack({layer(0.01 * tau, 0.99 * tau, g, 1.4, 1.0)});
    const Incidence incidence{.theta = 1.2};
    const auto seen = adding_doubling(stack, incidence, {.accuracy = accuracy});
    const auto truth =
        adding_doubling(stack, incidence, {.accuracy = 1e-10, .max_nodes = 200}).totals;
    const double error =
        std::max(std::abs(seen.totals.diffuse_reflectance - truth.diffuse_reflectance),
                 std::abs(seen.totals.transmittance - truth.transmittance));
    EXPECT_LE(error, seen.estimated_error) << g << ", " << tau << ", " << accuracy;
    EXPECT_LE(seen.estimated_error, std::max(accuracy, 1e-4));  // and it is of use
  }
}

// [Chandrasekhar1960]: a half-space of isotropic scattering reflects 1 - H(mu) sqrt(1 - albedo),
// and H is 1 at grazing incidence. Nearer to it than the sine can tell, too.
TEST(AddingDoubling, HalfSpaceAtGrazingIncidenceAgreesWithChandrasekhar) {
  const LayerStack stack({layer(1.0, 9.0, 0.0, 1.0, infinite)});
  for (const double degrees : {89.9999995, 89.99999999, std::nextafter(90.0, 0.0)}) {
    const auto totals = adding_doubling(stack, oblique(degrees), fine).totals;
    EXPECT_NEAR(totals.diffuse_reflectance, 1.0 - std::sqrt(0.1), 1e-6) << degrees;
  }
}

// A grazing beam is mirrored where indices differ; where they do not, totals have a limit.
TEST(AddingDoubling, TotalsGoToTheirLimitAtGrazingIncidence) {
  for (const double ior : {1.0, 1.4})
    for (const double sigma_a : {0.0, 0.1}) {
      const LayerStack stack(
          {layer(sigma_a, 10.0, 0.8, ior, 0.5), layer(0.2, 5.0, 0.0, 1.33, 0.5)});
      const auto near = adding_doubling(stack, oblique(89.9999), fine).totals;
      for (const double degrees : {89.9999995, 89.99999999, std::nextafter(90.0, 0.0)}) {
        const auto totals = adding_doubling(stack, oblique(degrees), fine).totals;
        EXPECT_NEAR(sum(totals), 1.0, 1e-9) << ior << ", " << degrees;
        EXPECT_NEAR(totals.specular_reflectance, ior == 1.0 ? 0.0 : 1.0, 1e-7);
        EXPECT_NEAR(totals.diffuse_reflectance, near.diffuse_reflectance, 5e-5);
        EXPECT_NEAR(totals.transmittance, near.transmittance, 5e-5);
      }
    }
}

// A stack of plates without scattering: r + t^2 a^2 r / (1 - r^2 a^2), interreflections summed.
TEST(AddingDoubling, PlateThatAbsorbsHasAllInterreflections) {
  const double degrees = 50.0, ior = 1.5, sigma_a = 0.7, d = 0.4;
  const auto result =
      adding_doubling(LayerStack({layer(sigma_a, 0.0, 0.0, ior, d)}), oblique(degrees));
  const double mu = std::cos(degrees * std::numbers::pi / 180.0);
  const double inside = cos_refracted(mu, ior), r = fresnel(mu, ior);
  const double a = std::exp(-sigma_a * d / inside);
  const double t = (1.0 - r) * (1.0 - r) * a / (1.0 - r * r * a * a);
  EXPECT_NEAR(result.totals.transmittance, t, 1e-14);
  EXPECT_NEAR(result.unscattered_transmittance, t, 1e-14);
  EXPECT_NEAR(result.totals.specular_reflectance, r, 1e-14);
  EXPECT_NEAR(result.totals.diffuse_reflectance, r * a * t, 1e-14);
  EXPECT_NEAR(result.unscattered_reflectance, r + r * a * t, 1e-14);
}

// A clear plate returns 2r / (1 + r) of the light at normal incidence.
TEST(AddingDoubling, ClearPlateTransmitsTheRest) {
  for (const double ior : {1.0, 1.2, 2.5}) {
    const auto totals = adding_doubling(LayerStack({layer(0.0, 0.0, 0.0, ior, 1.0)})).totals;
    const double r = fresnel(1.0, ior);
    EXPECT_NEAR(totals.transmittance, (1.0 - r) / (1.0 + r), 1e-14);
    EXPECT_NEAR(totals.absorptance[0], 0.0, 1e-14);
  }
}

// [Saunderson1942]: a Lambertian ground under a clear coat.
TEST(AddingDoubling, CoatedGroundFollowsSaunderson) {
  const double ior = 1.5, rho = 0.7;
  const LayerStack coat({layer(0.0, 0.0, 0.0, ior, 1.0)}, 1.0, ior, {.reflectance = rho});
  const double inside = fresnel_diffuse(1.0 / ior);
  for (const Incidence& incidence : {Incidence{}, diffuse}) {
    const double first = incidence.is_diffuse ? fresnel_diffuse(ior) : fresnel(1.0, ior);
    const auto totals = adding_doubling(coat, incidence, fine).totals;
    EXPECT_NEAR(totals.specular_reflectance, first, 1e-6);
    EXPECT_NEAR(totals.diffuse_reflectance,
                (1.0 - first) * (1.0 - inside) * rho / (1.0 - rho * inside), 1e-6);
    EXPECT_NEAR(totals.transmittance,
                1.0 - totals.specular_reflectance - totals.diffuse_reflectance, 1e-10);
  }
}

TEST(AddingDoubling, WhiteGroundUnderAScattererReturnsAll) {
  const LayerStack white({layer(0.0, 5.0, 0.8, 1.4, 0.3)}, 1.0, 1.0, {.reflectance = 1.0});
  const auto totals = adding_doubling(white, oblique(30.0)).totals;
  EXPECT_NEAR(totals.specular_reflectance + totals.diffuse_reflectance, 1.0, 1e-10);
}

TEST(AddingDoubling, HalfSpaceThatDoesNotAbsorbReturnsAllTheLight) {
  for (const double g : {0.0, 0.9}) {
    const LayerStack half_space({layer(0.0, 3.0, g, 1.4, infinite)}, 1.0, 1.4);
    const auto totals = adding_doubling(half_space).totals;
    EXPECT_NEAR(totals.specular_reflectance + totals.diffuse_reflectance, 1.0, 1e-10);
  }
}

// Light diffuses through: T = (4/3) / (tau + 2 * 0.710446) for Lambertian light, Milne's problem.
TEST(AddingDoubling, ThickestSlabsStillTransmit) {
  for (const double tau : {1e3, 1e6, 1e9}) {
    const LayerStack slab({layer(0.0, 1.0, 0.0, 1.0, tau)});
    const auto totals = adding_doubling(slab, diffuse, fine).totals;
    EXPECT_NEAR(totals.transmittance * 0.75 * (tau + 2.0 * 0.71044609), 1.0, 1e-5) << "tau " << tau;
    EXPECT_NEAR(totals.absorptance[0], 0.0, 1e-12);
  }
}

// By conservation: what gets through is 1e-13 of the light, below rounding.
TEST(AddingDoubling, SlabsThatLetLessThanRoundingThroughReturnTheRest) {
  for (double optical = 1e12; optical < 1e17; optical *= 1.7)
    for (const double co_albedo : {0.0, 4e-27, 1e-17, 3e-16, 1e-14})
      for (const double outside : {0.3, 1.0}) {
        const double sigma_s = optical / 9149.7;
        const LayerStack stack({layer(co_albedo * sigma_s, sigma_s, 0.0, 1.0, 9149.7)}, outside,
                               outside);
        for (const double accuracy : {1e-2, 1e-6}) {
          const AddingDoublingTotals found = adding_doubling(stack, {}, {.accuracy = accuracy});
          EXPECT_NEAR(sum(found.totals), 1.0, 1e-4)
              << optical << " " << co_albedo << " " << outside << " " << accuracy;
          EXPECT_NEAR(found.totals.specular_reflectance + found.totals.diffuse_reflectance, 1.0,
                      1e-4);
        }
      }
}

TEST(AddingDoubling, HalfSpacesThatTurnLightStraightBackReturnAll) {
  const LayerStack stack({layer(1e-9, 1e9, -1.0 + 1e-9, 1.0, infinite)});
  for (const double degrees : {0.0, 30.0, 60.0, 80.0, 87.12, 89.0})
    for (const double accuracy : {1e-2, 1e-6}) {
      const auto totals = adding_doubling(stack, oblique(degrees), {.accuracy = accuracy}).totals;
      EXPECT_NEAR(totals.diffuse_reflectance, 1.0, 1e-4) << degrees << " " << accuracy;
      EXPECT_NEAR(sum(totals), 1.0, 1e-4) << degrees << " " << accuracy;
    }
}

TEST(AddingDoubling, ClearHalfSpaceSwallowsTheLight) {
  const LayerStack water({layer(0.0, 0.0, 0.0, 1.33, infinite)}, 1.0, 1.33);
  const auto totals = adding_doubling(water).totals;
  EXPECT_NEAR(totals.transmittance, 1.0 - fresnel(1.0, 1.33), 1e-14);
  EXPECT_NEAR(totals.diffuse_reflectance, 0.0, 1e-15);
}

// Doubling all coefficients and halving the thickness changes nothing.
TEST(AddingDoubling, OnlyOpticalThicknessCounts) {
  const auto a = adding_doubling(LayerStack({layer(1.0, 30.0, 0.9, 1.4, 0.2)})).totals;
  const auto b = adding_doubling(LayerStack({layer(2.0, 60.0, 0.9, 1.4, 0.1)})).totals;
  EXPECT_NEAR(a.diffuse_reflectance, b.diffuse_reflectance, 1e-13);
  EXPECT_NEAR(a.transmittance, b.transmittance, 1e-13);
}

TEST(AddingDoubling, CuttingALayerChangesNothing) {
  const auto whole = adding_doubling(LayerStack({layer(1.0, 30.0, 0.9, 1.4, 0.2)})).totals;
  const auto cut = adding_doubling(LayerStack({layer(1.0, 30.0, 0.9, 1.4, 0.05),
                                               layer(1.0, 30.0, 0.9, 1.4, 0.15)}))
                       .totals;
  EXPECT_NEAR(whole.diffuse_reflectance, cut.diffuse_reflectance, 1e-11);
  EXPECT_NEAR(whole.absorptance[0], cut.absorptance[0] + cut.absorptance[1], 1e-11);
}

// Indices that differ in the tenth digit only: no needle-thin segment of directions.
TEST(AddingDoubling, NearlyEqualIndicesAreOne) {
  const auto one = adding_doubling(LayerStack({layer(0.1, 9.0, 0.5, 1.4, 0.5)}, 1.0, 1.4)).totals;
  const auto near =
      adding_doubling(LayerStack({layer(0.1, 9.0, 0.5, 1.4, 0.5)}, 1.0, 1.4 + 1e-10)).totals;
  EXPECT_NEAR(one.transmittance, near.transmittance, 1e-8);
  const auto apart =
      adding_doubling(LayerStack({layer(0.1, 9.0, 0.5, 1.4, 0.5)}, 1.0, 1.4 + 1e-6)).totals;
  EXPECT_NEAR(one.transmittance, apart.transmittance, 2e-5);
}

TEST(AddingDoubling, MixtureOfEqualsIsTheOne) {
  Layer mixed = layer(1.0, 9.0, 0.75, 1.0, 0.2);
  mixed.phase = PhaseMixture{{{0.3, HenyeyGreenstein{0.75}}, {0.7, HenyeyGreenstein{0.75}}}};
  EXPECT_NEAR(adding_doubling(LayerStack({mixed}), {}, fine).totals.diffuse_reflectance, 0.0973946,
              1e-7);
}

// Rayleigh scattering without absorption; H-functions of [Chandrasekhar1960] are not for this, but
// a slab so thin that light scatters once sends back the backward half: tau / 2 of normal light.
TEST(AddingDoubling, ThinRayleighSlabScattersHalfBack) {
  Layer thin = layer(0.0, 1.0, 0.0, 1.0, 1e-5);
  thin.phase = Rayleigh{};
  EXPECT_NEAR(adding_doubling(LayerStack({thin}), {}, fine).totals.diffuse_reflectance, 0.5e-5,
              1e-8);
}

TEST(AddingDoubling, StrongBackwardScatteringConverges) {
  const LayerStack slab({layer(0.5, 9.0, -0.95, 1.3, 0.3)});
  const auto result = adding_doubling(slab, {}, {.accuracy = 1e-6});
  EXPECT_TRUE(result.is_accurate);
  EXPECT_NEAR(sum(result.totals), 1.0, 1e-10);
}

RC_GTEST_PROP(AddingDoubling, AnyStackKeepsItsEnergy, ()) {
  const auto uniform = [](double low, double high) {
    return low + (high - low) * *rc::gen::inRange(0, 1001) / 1000.0;
  };
  std::vector<Layer> layers;
  const int count = *rc::gen::inRange(1, 5);
  for (int k = 0; k < count; ++k) {
    const bool clear = *rc::gen::inRange(0, 5) == 0;
    const double sigma_s = clear ? 0.0 : std::pow(10.0, uniform(-6.0, 4.0));
    const bool absorbs = *rc::gen::inRange(0, 3) != 0;
    layers.push_back(layer(absorbs ? std::pow(10.0, uniform(-6.0, 4.0)) : 0.0, sigma_s,
                           uniform(-0.99, 0.99), uniform(1.0, 2.5),
                           std::pow(10.0, uniform(-3.0, 2.0))));
  }
  const LayerStack stack(layers, uniform(1.0, 1.6), uniform(1.0, 1.6),
                         {.reflectance = *rc::gen::element(0.0, 0.5, 1.0)});
  const auto totals = adding_doubling(stack, oblique(uniform(0.0, 89.9)), {.accuracy = 0.1}).totals;
  RC_ASSERT(std::abs(sum(totals) - 1.0) < 1e-10);
  RC_ASSERT(totals.diffuse_reflectance > -1e-9 && totals.transmittance > -1e-9);
  for (const double absorptance : totals.absorptance) RC_ASSERT(absorptance > -1e-9);
}

TEST(AddingDoubling, RefusesWhatItCannotDo) {
  const LayerStack slab({layer(1.0, 9.0, 0.75, 1.0, 0.2)});
  EXPECT_THROW((void)adding_doubling(slab, oblique(90.0)), InvalidInput);
  EXPECT_THROW((void)adding_doubling(slab, {.theta = std::nan("")}), InvalidInput);
  EXPECT_THROW((void)adding_doubling(slab, {}, {.accuracy = 0.0}), InvalidInput);
  EXPECT_THROW((void)adding_doubling(slab, {}, {.max_nodes = 1}), InvalidInput);
}

TEST(AddingDoubling, SaysWhenItFallsShort) {
  const LayerStack sharp({layer(0.1, 30.0, 0.95, 1.4, 0.2)});
  const auto result = adding_doubling(sharp, {}, {.accuracy = 1e-8, .max_nodes = 12});
  EXPECT_FALSE(result.is_accurate);
  EXPECT_GT(result.estimated_error, 1e-8);
  EXPECT_EQ(result.nodes, 12);
}

TEST(AddingDoubling, ManyAnglesAtOnceAreAsOneByOne) {
  const LayerStack stack(
      {{.medium = {.sigma_a = 0.2, .sigma_s = 3.0, .g = 0.6, .ior = 1.4}, .thickness = 0.5},
       {.medium = {.sigma_a = 1.0, .sigma_s = 5.0, .g = 0.1, .ior = 1.33}, .thickness = 0.4}});
  const std::vector<Incidence> incidences = {
      {.theta = 0.0}, {.theta = 0.7}, {.is_diffuse = true}, {.theta = 1.5}};
  const auto together = adding_doubling_by_angle(stack, incidences, {.accuracy = 1e-8});
  for (std::size_t i = 0; i < incidences.size(); ++i) {
    const auto alone = adding_doubling(stack, incidences[i], {.accuracy = 1e-8});
    EXPECT_TRUE(together[i].is_accurate);
    EXPECT_NEAR(together[i].totals.diffuse_reflectance, alone.totals.diffuse_reflectance, 1e-8);
    EXPECT_NEAR(together[i].totals.transmittance, alone.totals.transmittance, 1e-8);
    EXPECT_NEAR(together[i].unscattered_transmittance, alone.unscattered_transmittance, 1e-12);
  }
}

}  // namespace
}  // namespace lamina

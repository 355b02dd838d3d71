// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/layers/optics/rough/rough_surface_scattering.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "lamina/base/core/error.h"
#include "lamina/base/core/parallel.h"
#include "lamina/layers/optics/rough/gaussian_height_field.h"
#include "lamina/layers/optics/rough/interface_reflectance.h"

namespace lamina {
namespace {

constexpr double degree = std::numbers::pi / 180.0;

double projected_solid_angle(ExitCells cells, int theta) {
  const double step = 90.0 * degree / cells.thetas;
  return std::numbers::pi / cells.phis *
         (std::pow(std::sin((theta + 1) * step), 2) - std::pow(std::sin(theta * step), 2));
}

double flux_of(const RoughSurfaceScattering& result, const std::vector<double>& bsdf) {
  double flux = 0.0;
  for (std::size_t k = 0; k < bsdf.size(); ++k)
    flux += bsdf[k] * projected_solid_angle(result.cells, static_cast<int>(k) / result.cells.phis);
  return flux;
}

TEST(RoughSurfaceScattering, CellsAddUpToTheTotals) {
  const GaussianSurface surface{2.0, 1.4};
  const auto analytic = analytic_scattering(surface, 40.0 * degree);
  EXPECT_NEAR(flux_of(analytic, analytic.brdf), analytic.reflectance.value, 2e-4);
  EXPECT_NEAR(flux_of(analytic, analytic.btdf), analytic.transmittance.value, 2e-4);
  for (const auto& walk :
       {simulate_scattering(surface, 40.0 * degree, {.rays = 20'000}),
        trace_height_fields(surface, 40.0 * degree, {.rays = 20'000, .realizations = 2})}) {
    EXPECT_NEAR(flux_of(walk, walk.brdf), walk.reflectance.value, 1e-12);
    EXPECT_NEAR(flux_of(walk, walk.btdf), walk.transmittance.value, 1e-12);
    EXPECT_NEAR(flux_of(walk, walk.single_btdf), walk.single_transmittance.value, 1e-12);
    EXPECT_EQ(walk.given_up, 0.0);
  }
}

// Their Lambda gives V(height) averages of 1 / (1 + Lambda), against facets turned to the light of
// 1 + Lambda of Smith: more light arrives than starts.
TEST(RoughSurfaceScattering, VisibilityOfThePaperLosesEnergyAtTheStartAndSmithsDoesNot) {
  const auto start = [](FacetVisibility visibility, double s, double theta) {
    return simulate_scattering({s, 1.4}, theta * degree,
                               {.rays = 200'000, .seed = 3, .visibility = visibility})
        .start_weight;
  };
  const Estimate at_30 = start(FacetVisibility::xu_sun, 1.0, 30.0);
  EXPECT_NEAR(at_30.value, 0.82, 0.005 + 4.0 * at_30.standard_error);
  const Estimate at_60 = start(FacetVisibility::xu_sun, 1.0, 60.0);
  EXPECT_NEAR(at_60.value, 0.60, 0.005 + 4.0 * at_60.standard_error);
  for (const double s : {0.5, 1.0, 3.0, 10.0})
    for (const double theta : {0.0, 60.0}) {
      const Estimate kept = start(FacetVisibility::smith, s, theta);
      EXPECT_NEAR(kept.value, 1.0, 4.0 * kept.standard_error + 1e-12) << s << " " << theta;
      EXPECT_LT(kept.standard_error, 0.006);
    }
}

TEST(RoughSurfaceScattering, SmithsWalkOfOrderOneIsTheMicrofacetInterface) {
  for (const double eta : {1.4, 1.0 / 1.4}) {
    const GaussianSurface surface{2.0, eta};
    const InterfaceReflectance table = make_interface_reflectance(make_rough_interface(surface));
    const auto walk =
        simulate_scattering(surface, std::acos(0.75),
                            {.rays = 100'000, .seed = 4, .visibility = FacetVisibility::smith});
    EXPECT_NEAR(walk.single_reflectance.value, reflectance(table, 0.75),
                4.0 * walk.single_reflectance.standard_error + 7e-4);
    EXPECT_NEAR(walk.single_transmittance.value, transmittance(table, 0.75),
                4.0 * walk.single_transmittance.standard_error + 7e-4);
    EXPECT_NEAR(walk.reflectance.value + walk.transmittance.value, walk.start_weight.value, 1e-12);
  }
}

// sigma = 1 and tau = 1 in the field's own units; 8 squares of 40 x 40 correlation lengths hold
// some 8000 independent heights, so 2 % of the variance is 1.3 standard deviations.
TEST(GaussianHeightField, HasTheStatisticsOfTheSurface) {
  constexpr int squares = 8, cells = 16;
  constexpr double s = 2.0;
  double variance = 0.0, slope_variance = 0.0, at_tau = 0.0, fourth = 0.0;
  for (int k = 0; k < squares; ++k) {
    Random random = make_random(5, static_cast<std::uint64_t>(k));
    const GaussianHeightField field({.smoothness = s, .cells_per_correlation = cells}, random);
    const int n = field.size();
    for (int y = 0; y < n; ++y)
      for (int x = 0; x < n; ++x) {
        const double h = field.height(x, y) * s / cells;  // in sigma
        const double slope = field.height(x + 1, y) - field.height(x, y);
        const double norm = 1.0 / (1.0 * n * n * squares);
        variance += h * h * norm, fourth += h * h * h * h * norm;
        slope_variance += slope * slope * norm;
        at_tau += h * field.height((x + cells) % n, y) * s / cells * norm;
      }
  }
  EXPECT_NEAR(variance, 1.0, 0.06);
  EXPECT_NEAR(at_tau / variance, std::exp(-1.0), 0.04);
  EXPECT_NEAR(slope_variance, 2.0 / (s * s) * variance, 0.06 * 2.0 / (s * s));
  EXPECT_NEAR(fourth / (variance * variance), 3.0, 0.2);  // Gaussian heights
}

TEST(GaussianHeightField, IsFresnelWhenNearlyFlat) {
  for (const double eta : {1.5, 1.0 / 1.5}) {
    const auto field =
        trace_height_fields({300.0, eta}, 30.0 * degree, {.rays = 60'000, .realizations = 4});
    const double f = fresnel(std::cos(30.0 * degree), eta);
    EXPECT_NEAR(field.reflectance.value, f, 4.0 * std::sqrt(f * (1.0 - f) / 60'000.0) + 1e-4);
    EXPECT_NEAR(field.reflectance.value + field.transmittance.value, 1.0, 1e-12);
  }
}

// Two independent roads to the same light: facets at independent heights, and a real surface. They
// differ by what correlation does, some 1 to 3 % of the light of order 1.
TEST(RoughSurfaceScattering, SmithsWalkAgreesWithTheHeightField) {
  for (const double eta : {1.4, 1.0 / 1.4})
    for (const double s : {3.0, 1.0}) {
      const GaussianSurface surface{s, eta};
      const auto walk =
          simulate_scattering(surface, 30.0 * degree,
                              {.rays = 60'000, .seed = 5, .visibility = FacetVisibility::smith});
      const auto field = trace_height_fields(surface, 30.0 * degree, {.rays = 60'000, .seed = 6});
      EXPECT_NEAR(walk.transmittance.value, field.transmittance.value, 0.025) << s << " " << eta;
      EXPECT_NEAR(walk.single_transmittance.value, field.single_transmittance.value, 0.04)
          << s << " " << eta;
    }
}

// [XuSun2008] Figures 8 and 9: the analytic model is good at s >= 3 and worse below.
TEST(RoughSurfaceScattering, AnalyticModelIsGoodForSmoothSurfacesAndPoorForRough) {
  const auto misfit = [](double s) {
    const GaussianSurface surface{s, 1.4};
    const auto field = trace_height_fields(surface, 30.0 * degree, {.rays = 60'000, .seed = 8});
    return std::abs(analytic_scattering(surface, 30.0 * degree).transmittance.value -
                    field.single_transmittance.value);
  };
  EXPECT_LT(misfit(6.0), 0.005);
  EXPECT_LT(misfit(3.0), 0.01);
  EXPECT_GT(misfit(1.0), 0.2);
}

TEST(RoughSurfaceScattering, DependsOnTheSeedAndNotOnThreads) {
  const auto btdf = [](int threads, std::uint64_t seed) {
    set_thread_count(threads);
    const auto walk = simulate_scattering({1.0, 1.4}, 0.5, {.rays = 5'000, .seed = seed}).btdf;
    const auto field =
        trace_height_fields({1.0, 1.4}, 0.5, {.rays = 2'000, .realizations = 2, .seed = seed}).btdf;
    set_thread_count(0);
    return std::pair(walk, field);
  };
  EXPECT_EQ(btdf(1, 1), btdf(2, 1));
  EXPECT_NE(btdf(1, 1), btdf(1, 2));
}

TEST(RoughSurfaceScattering, StopsWhenAskedAndHandsOverWhatItHas) {
  const auto stopped = simulate_scattering(
      {3.0, 1.4}, 0.5, {.rays = 1'000'000'000'000, .progress = [](double) { return false; }});
  EXPECT_NEAR(stopped.reflectance.value + stopped.transmittance.value, 1.0, 0.05);
}

TEST(RoughSurfaceScattering, RefusesWhatIsNoSurface) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW((void)analytic_scattering({0.0, 1.4}, 0.5), InvalidInput);
  EXPECT_THROW((void)analytic_scattering({nan, 1.4}, 0.5), InvalidInput);
  EXPECT_THROW((void)analytic_scattering({1.0, 1.0}, 0.5), InvalidInput);
  EXPECT_THROW((void)analytic_scattering({1.0, -1.0}, 0.5), InvalidInput);
  EXPECT_THROW((void)analytic_scattering({1.0, 1.4}, 1.6), InvalidInput);
  EXPECT_THROW((void)simulate_scattering({1.0, 1.4}, 0.5, {.rays = 0}), InvalidInput);
  EXPECT_THROW((void)trace_height_fields({1.0, 1.4}, 0.5, {.realizations = 1}), InvalidInput);
  EXPECT_THROW((void)trace_height_fields({1.0, 1.4}, 1.57, {.rays = 1}), InvalidInput);
}

}  // namespace
}  // namespace lamina

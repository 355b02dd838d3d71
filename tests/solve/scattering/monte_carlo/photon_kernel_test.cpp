// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <cmath>
#include <numbers>

#include "lamina/solve/scattering/monte_carlo/photon_tracing.h"
#include "literal/stack_table.h"
#include "solve/scattering/monte_carlo/scalar_photons.h"
#include "solve/scattering/only_target.h"

namespace lamina {
namespace {

/// Sum of squared deviations in units of their errors, of all bins that hold enough light for the
/// central limit; and their number.
struct ChiSquare {
  double sum = 0.0;
  int count = 0;
  void add(const Estimate& a, double b, double error_b) {
    const double variance = a.standard_error * a.standard_error + error_b * error_b;
    if (!(a.value * a.value > 50.0 * variance)) return;
    sum += (a.value - b) * (a.value - b) / variance;
    ++count;
  }
  /// In standard deviations of the chi-square distribution.
  [[nodiscard]] double excess() const { return (sum - count) / std::sqrt(2.0 * count); }
};

constexpr reference::ScalarGrid grid = {
    .radii = 12, .angles = 9, .depths = 8, .dr = .05, .dz = .05};

// Every instruction set that this machine has against the literal scalar version, on a slab whose
// layers differ in everything, under oblique light.
TEST(PhotonKernel, EveryTargetAgreesWithTheScalarVersion) {
  const auto table = reference::stack_table();
  for (const char* name : {"four mismatched layers", "denser on lighter", "skin, red"}) {
    const auto found =
        std::ranges::find_if(table, [&](const auto& entry) { return entry.name == name; });
    ASSERT_NE(found, table.end());
    const int n = 20'000;
    const double theta = 0.7;
    const auto scalar = reference::trace_scalar_photons(found->stack, n, 17, theta, grid);
    int targets = 0;
    for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
      const OnlyTarget only(target);
      SCOPED_TRACE(std::string(name) + ", " + hwy::TargetName(target));
      const MonteCarloResult simd =
          trace_photons(found->stack, {.photons = 40'000,
                                       .seed = 18,
                                       .incidence = {.theta = theta},
                                       .tallies = {.r = {grid.radii, grid.dr},
                                                   .angles = grid.angles,
                                                   .depth = {grid.depths, grid.dz},
                                                   .orders = true,
                                                   .mean_path_length = true}});
      EXPECT_NEAR(simd.specular_reflectance.value, scalar.specular_reflectance, 1e-12);
      ChiSquare chi;
      const auto compare = [&](const Estimate& a, const reference::ScalarSum& b, double scale) {
        chi.add({a.value * scale, a.standard_error * scale}, b.mean(n), b.standard_error(n));
      };
      compare(simd.diffuse_reflectance, scalar.reflectance, 1.0);
      compare(simd.transmittance, scalar.transmittance, 1.0);
      compare(simd.unscattered_transmittance, scalar.unscattered_transmittance, 1.0);
      for (std::size_t i = 0; i < simd.absorptance.size(); ++i)
        compare(simd.absorptance[i], scalar.absorptance[i], 1.0);
      for (int i = 0; i < grid.radii; ++i) {
        const double area = std::numbers::pi * grid.dr * grid.dr * (2 * i + 1);
        compare(simd.radial.reflection[static_cast<std::size_t>(i)],
                scalar.radial[static_cast<std::size_t>(i)], area);
        compare(simd.radial.transmission[static_cast<std::size_t>(i)],
                scalar.radial_below[static_cast<std::size_t>(i)], area);
      }
      for (int i = 0; i < grid.angles; ++i) {
        const double a = 0.5 * std::numbers::pi / grid.angles;
        compare(simd.angular.reflection[static_cast<std::size_t>(i)],
                scalar.angular[static_cast<std::size_t>(i)],
                2.0 * std::numbers::pi * (std::cos(i * a) - std::cos((i + 1) * a)));
      }
      for (std::size_t i = 1; i < scalar.order.size(); ++i)
        compare(simd.by_order.reflection[i], scalar.order[i], 1.0);
      EXPECT_GT(chi.count, 20);
      EXPECT_LT(chi.excess(), 4.0) << chi.sum << " over " << chi.count;
      // The scalar grid of absorption has no errors of its own; it has half the photons.
      for (std::size_t i = 0; i < simd.absorption.size(); ++i) {
        const auto ring = static_cast<int>(i) / grid.depths;
        const double volume = std::numbers::pi * grid.dr * grid.dr * (2 * ring + 1) * grid.dz;
        const Estimate& a = simd.absorption[i];
        EXPECT_NEAR(a.value * volume, scalar.absorbed_rz[i] / n,
                    6.0 * std::sqrt(3.0) * a.standard_error * volume + 2e-4)
            << i;
      }
      EXPECT_NEAR(simd.mean_path_reflected.value, scalar.path_up.sum / scalar.reflectance.sum,
                  5.0 * std::sqrt(3.0) * simd.mean_path_reflected.standard_error);
      ++targets;
    }
    EXPECT_GE(targets, 1);
  }
}

/// The part of the light that two runs have in different cells.
double moved_light(const std::vector<WideSum>& a, const std::vector<WideSum>& b) {
  double moved = 0.0, all = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    moved += std::abs(to_double(a[i], 40) - to_double(b[i], 40));
    all += std::abs(to_double(a[i], 40));
  }
  return moved / all;
}

// What fuses multiplication and addition (AVX2, AVX-512) gives the same bits. What does not (SSE,
// scalar) rounds once more, which moves the photons at the edges of cells, and some of those that a
// boundary just reflects.
TEST(PhotonKernel, EveryTargetCountsTheSameLight) {
  const auto fuses = [](std::int64_t target) {
    return (target & (HWY_AVX2 | HWY_AVX3 | HWY_AVX3_DL | HWY_NEON)) != 0;
  };
  for (const auto& [name, stack] : reference::stack_table()) {
    if (name != "four mismatched layers" && name != "denser on lighter" && name != "skin, red")
      continue;
    struct Run {
      std::int64_t target;
      PhotonCounts counts;
    };
    std::vector<Run> runs;
    for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
      const OnlyTarget only(target);
      runs.push_back({target, count_photons(stack, {.photons = 50'000,
                                                    .seed = 19,
                                                    .incidence = {.theta = 0.7},
                                                    .tallies = {.r = {100, 0.02},
                                                                .angles = 9,
                                                                .depth = {100, 0.01},
                                                                .fluence = true,
                                                                .orders = true,
                                                                .mean_path_length = true}})});
    }
    for (const Run& run : runs) {
      SCOPED_TRACE(name + ", " + hwy::TargetName(run.target));
      const PhotonCounts& best = runs[0].counts;
      if (fuses(run.target) == fuses(runs[0].target)) {
        EXPECT_EQ(run.counts.first, best.first);
        EXPECT_EQ(run.counts.second, best.second);
        EXPECT_EQ(run.counts.volume_first, best.volume_first);
        EXPECT_EQ(run.counts.volume_second, best.volume_second);
      } else {
        EXPECT_LT(moved_light(best.first, run.counts.first), 5e-5);
        EXPECT_LT(moved_light(best.volume_first, run.counts.volume_first), 5e-5);
        const MonteCarloResult a = summarize(best), b = summarize(run.counts);
        EXPECT_NEAR(a.diffuse_reflectance.value, b.diffuse_reflectance.value, 2e-5);
        EXPECT_NEAR(a.transmittance.value, b.transmittance.value, 2e-5);
      }
    }
  }
}

}  // namespace
}  // namespace lamina

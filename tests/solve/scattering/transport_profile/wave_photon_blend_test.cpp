// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/transport_profile/internal/wave_photon_blend.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "lamina/base/core/random.h"

namespace lamina::detail {
namespace {

constexpr double photons = 1e5;
constexpr std::size_t radii = 120;

/// A profile whose flux within r is 1 - exp(-2 r), and photons that count it with their noise.
double truth(double r) { return std::exp(-2.0 * r) / (std::numbers::pi * r); }

struct Light {
  std::vector<double> r, exact, none;
  RingFlux rings{.first_radius = 0.005, .log_width = 0.02};
};

Light make_light() {
  Light light;
  for (std::size_t i = 0; i < radii; ++i) {
    light.r.push_back(0.02 * std::pow(200.0, static_cast<double>(i) / (radii - 1.0)));
    light.exact.push_back(truth(light.r.back()));
  }
  light.none.assign(radii, 0.0);
  Random random = make_random(6, 2);
  const auto counted = [&](double from, double to) {
    const double share = std::exp(-2.0 * from) - std::exp(-2.0 * to);
    const double normal = std::sqrt(-2.0 * std::log(1.0 - random.uniform())) *
                          std::cos(2.0 * std::numbers::pi * random.uniform());
    const double hits =
        std::round(std::max(0.0, photons * share + std::sqrt(photons * share) * normal));
    return Estimate{hits / photons, (std::sqrt(hits) + 1.0) / photons};
  };
  light.rings.nearer = counted(0.0, light.rings.first_radius);
  for (std::size_t i = 0; i < 370; ++i)
    light.rings.flux.push_back(counted(light.rings.begin_of(i), light.rings.begin_of(i + 1)));
  return light;
}

/// Waves that are wrong by a fraction which turns with r, and say so or not.
BlendedCurve blended(const Light& light, double wrong, double stated) {
  std::vector<double> density, error, change;
  for (std::size_t i = 0; i < radii; ++i) {
    const double off = std::cos(8.0 * std::log(light.r[i]));
    density.push_back(light.exact[i] * (1.0 + wrong * off));
    error.push_back(stated * light.exact[i]);
    change.push_back(error.back() * off);
  }
  return blend(light.r, {density, error, {change}, 200.0}, light.none, 0.0, light.rings, photons);
}

/// Root mean square of the relative errors where photons are many.
double rms(const Light& light, const BlendedCurve& curve) {
  double sum = 0.0, count = 0.0;
  for (std::size_t i = 0; i < radii; ++i) {
    if (light.r[i] < 0.05 || light.r[i] > 1.0) continue;
    sum += std::pow(curve.density[i] / light.exact[i] - 1.0, 2.0);
    count += 1.0;
  }
  return std::sqrt(sum / count);
}

TEST(WavePhotonBlend, KeepsWavesThatAreRight) {
  const Light light = make_light();
  EXPECT_LT(rms(light, blended(light, 0.0, 1e-4)), 1e-3);  // photons alone: some 1e-2
}

TEST(WavePhotonBlend, TakesPhotonsWhereWavesSayThatTheyAreWrong) {
  const Light light = make_light();
  EXPECT_LT(rms(light, blended(light, 0.3, 0.3)), 0.03);
}

TEST(WavePhotonBlend, FindsOutWavesThatDoNotSayIt) {
  const Light light = make_light();
  const BlendedCurve curve = blended(light, 0.3, 1e-4);
  EXPECT_LT(rms(light, curve), 0.05);
  std::size_t within = 0, all = 0;
  for (std::size_t i = 0; i < radii; ++i) {
    if (light.r[i] < 0.05 || light.r[i] > 1.0) continue;
    within += std::abs(curve.density[i] - light.exact[i]) <= curve.error[i] ? 1 : 0;
    ++all;
  }
  EXPECT_GT(within, all * 7 / 10);
}

TEST(WavePhotonBlend, IsNeverNegative) {
  const Light light = make_light();
  const BlendedCurve curve = blended(light, 1.5, 1e-4);
  for (std::size_t i = 0; i < radii; ++i) {
    EXPECT_GE(curve.density[i], 0.0);
    EXPECT_GE(curve.error[i], 0.0);
  }
}

}  // namespace
}  // namespace lamina::detail

// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/lights/light_cluster_sampler.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lamina/base/core/random.h"
#include "lamina/scene/description/studio_environment.h"

namespace lamina {
namespace {

/// The procedural studio, a panel, a bulb and a distant light around the origin.
Scene lit_scene() {
  Scene scene;
  scene.images.push_back(make_studio_environment(64));
  scene.lights = {EnvironmentLight{.image = 0},
                  RectangleLight{.center = {-300, 100, 200},
                                 .edge_u = {80, 0, 120},
                                 .edge_v = {0, -150, 0},
                                 .radiance = {9, 8, 7}},
                  PointLight{.position = {100, 300, 200}, .intensity = {3e4f, 2e4f, 2e4f}},
                  DirectionalLight{.direction = {1, 2, 1}, .irradiance = {0.4f, 0.4f, 0.3f}}};
  return scene;
}

struct Estimate {
  double mean = 0.0, square = 0.0;
  int count = 0;
  void add(double x) { mean += x, square += x * x, ++count; }
  [[nodiscard]] double value() const { return mean / count; }
  [[nodiscard]] double variance() const { return square / count - value() * value(); }
};

// Both draw from all lights, so the mirrored light is the same; with a fifth of the variance.
TEST(LightClusterSampler, LeaveTheLightAsItIsWithLessNoise) {
  const Scene scene = lit_scene();
  const Lights lights(scene, {-100, -100, -100}, {100, 100, 100});
  ASSERT_GT(lights.cluster_count(), 100u);
  const BoundaryReflectance table(1.44f, MicrofacetDistribution::beckmann, 0.3f, false);
  SurfaceBoundary boundary;
  boundary.add({&table, 0.3f, 1.0f});
  const Vec3f position{10, -20, 30};
  Random random(7);
  for (const Vec3f& towards : {Vec3f{0.2f, 0.1f, 1.0f}, Vec3f{0.8f, 0.1f, 0.5f}}) {
    const Vec3f normal = normalize(Vec3f{0.1f, 0.3f, 1.0f});
    const Framef frame = make_frame(normal);
    const Vec3f wo = normalize(towards);
    const auto mirrored = [&](const LightSample& light) {
      if (!(light.pdf > 0.0f)) return 0.0;
      const Vec3f wi = frame.to_local(light.direction);
      return static_cast<double>(specular_brdf(boundary, wi, frame.to_local(wo)) *
                                 std::max(wi.z, 0.0f) * light.radiance.y / light.pdf);
    };
    const LightClusterSampler parts(lights, {boundary, normal, wo}, position);
    Estimate plain, chosen, all;
    const auto uniform = [&] { return random.uniform_float(); };
    for (int i = 0; i < 40'000; ++i) {
      plain.add(mirrored(lights.sample_light(position, uniform(), {uniform(), uniform()})));
      const auto [light, density_ratio] = parts.sample(uniform(), {uniform(), uniform()});
      ASSERT_GT(density_ratio, 0.0f);
      chosen.add(mirrored(light) / static_cast<double>(density_ratio));
      all.add(1.0 / static_cast<double>(density_ratio));
    }
    const double noise = std::sqrt((plain.variance() + chosen.variance()) / plain.count);
    EXPECT_NEAR(chosen.value(), plain.value(), 4.0 * noise);
    EXPECT_LT(chosen.variance(), 0.2 * plain.variance());
    EXPECT_GT(plain.value(), 10.0 * noise);
    // Each part is drawn so many times as often as without, and no part is left out.
    EXPECT_NEAR(all.value(), 1.0, 4.0 * std::sqrt(all.variance() / all.count));
  }
}

TEST(LightClusterSampler, PartsAreDrawnAsTheirLightsAre) {
  const Scene scene = lit_scene();
  const Lights lights(scene, {-100, -100, -100}, {100, 100, 100});
  float total = 0.0f;
  for (std::size_t i = 0; i < lights.cluster_count(); ++i) {
    total += lights.probability_of_cluster(i);
    const LightSample light = lights.sample_cluster(i, {0, 0, 0}, {0.3f, 0.6f});
    ASSERT_GT(light.pdf, 0.0f);
    if (light.is_delta || !std::isinf(light.distance)) continue;
    float pdf = 0.0f;  // of that direction, of all skies
    lights.for_lights_seen({{0, 0, 0}, light.direction}, 0.0f, light.distance, false,
                           [&](const LightSeen& seen) {
                             if (!std::isfinite(seen.distance)) pdf += seen.pdf;
                           });
    EXPECT_NEAR(light.pdf, pdf, 1e-2f * pdf) << "part " << i;
  }
  EXPECT_NEAR(total, 1.0f, 1e-5f);
}

TEST(LightClusterSampler, TooManyLightsAreNotCut) {
  Scene scene;
  for (int i = 0; i < 100; ++i)
    scene.lights.push_back(PointLight{.position = {1.0 * i, 300, 0}, .intensity = {1, 1, 1}});
  EXPECT_EQ(Lights(scene, {-1, -1, -1}, {1, 1, 1}).cluster_count(), 0u);
  EXPECT_EQ(Lights(Scene{}, {-1, -1, -1}, {1, 1, 1}).cluster_count(), 0u);
}

}  // namespace
}  // namespace lamina

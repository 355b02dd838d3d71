// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// Spot lights, balls and surfaces that shine: closed forms of their irradiance.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "lamina/base/core/error.h"
#include "lamina/base/core/random.h"
#include "lamina/render/lights/internal/light_shapes.h"
#include "lamina/render/lights/light_views.h"
#include "lamina/render/lights/lights.h"
#include "render/small_scenes.h"

namespace lamina {
namespace {

constexpr double pi = std::numbers::pi;

Scene white_square(int samples) {
  Scene scene;
  scene.camera = camera_above(0.01);
  scene.film = {.width = 2, .height = 2};
  scene.render = {.samples_per_pixel = samples, .max_bounces = 0};
  scene.materials = {diffuse_material(1.0f)};
  scene.meshes = {make_square(100.0f)};
  return scene;
}

/// What the middle of the square reflects, times pi: its irradiance.
double irradiance(const Scene& scene, const RenderOptions& options = {}) {
  return pi * mean_of(render(scene, options).image, 0);
}

SpotLight spot_above(double degrees_off, double inner, double outer) {
  const double off = degrees_off * pi / 180.0;
  return {.position = {0, 0, 50},
          .direction = {std::sin(off), 0, -std::cos(off)},
          .intensity = {1000, 1000, 1000},
          .cos_inner = static_cast<float>(std::cos(inner * pi / 180.0)),
          .cos_outer = static_cast<float>(std::cos(outer * pi / 180.0))};
}

TEST(SpotLights, AreAPointLightWithinTheInnerAngleAndDarkBeyondTheOuterOne) {
  Scene scene = white_square(1);
  const double full = 1000.0 / (50.0 * 50.0);
  for (const double off : {0.0, 9.99, 10.01, 20.0, 29.99, 30.01, 90.0}) {
    scene.lights = {spot_above(off, 10.0, 30.0)};
    const double t = (std::cos(off * pi / 180.0) - std::cos(pi / 6.0)) /
                     (std::cos(pi / 18.0) - std::cos(pi / 6.0));
    const double share = off < 10.0 ? 1.0 : off > 30.0 ? 0.0 : t * t * (3.0 - 2.0 * t);
    EXPECT_NEAR(irradiance(scene), full * share, 2e-4 * full) << off;
  }
  scene.lights = {spot_above(4.99, 5.0, 5.0)};  // a sharp edge
  EXPECT_NEAR(irradiance(scene), full, 2e-4 * full);
  scene.lights = {spot_above(5.01, 5.0, 5.0)};
  EXPECT_EQ(irradiance(scene), 0.0);
}

// The flux of the smooth step over the cosine c: 2 pi (1 - c_inner + (c_inner - c_outer) / 2).
TEST(SpotLights, GiveTheFluxOfTheirCone) {
  const float inner = 0.9f, outer = 0.6f;
  double sum = 0.0;
  constexpr int steps = 100'000;
  for (int i = 0; i < steps; ++i)
    sum += static_cast<double>(
               spot_share(-1.0f + 2.0f * (static_cast<float>(i) + 0.5f) / steps, inner, outer)) *
           2.0 / steps;
  EXPECT_NEAR(2.0 * pi * sum, 2.0 * pi * (0.1 + 0.15), 1e-4);
}

// A ball of radiance L at distance d from a surface that faces it gives pi L (r / d)², whatever its
// size: [Howell2010] configuration factor of a sphere seen whole.
TEST(SphereLights, GiveThePlaneTheIrradianceOfTheirConfigurationFactor) {
  for (const double radius : {0.001, 1.0, 20.0, 39.9}) {
    Scene scene = white_square(256);
    scene.lights = {SphereLight{.center = {0, 0, 40}, .radius = radius, .radiance = {3, 3, 3}}};
    const double expected = pi * 3.0 * radius * radius / 1600.0;
    EXPECT_NEAR(irradiance(scene), expected, 0.01 * expected) << radius;
  }
}

TEST(SphereLights, AreSampledAndMetAlike) {
  Scene scene = white_square(1024);
  scene.lights = {SphereLight{.center = {5, 10, 25}, .radius = 12, .radiance = {3, 3, 3}}};
  using Direct = RenderOptions::DirectLight;
  const double distance2 = 5.0 * 5.0 + 10.0 * 10.0 + 25.0 * 25.0;
  const double expected = pi * 3.0 * 144.0 / distance2 * 25.0 / std::sqrt(distance2);
  for (const Direct way : {Direct::combined, Direct::lights_only, Direct::surfaces_only})
    EXPECT_NEAR(irradiance(scene, {.direct_light = way}), expected, 0.03 * expected);
  // From within it is dark, for its inner side does not shine.
  scene.lights = {SphereLight{.center = {0, 0, 1}, .radius = 12, .radiance = {3, 3, 3}}};
  EXPECT_EQ(irradiance(scene), 0.0);
}

TEST(SphereLights, SamplesLieOnTheBallAndFollowTheirDensity) {
  const Vec3f center{3, -2, 7}, from{1, 1, 1};
  const float radius = 2.5f;
  const auto seen = see_ball(center, radius, from);
  ASSERT_TRUE(seen);
  Random random = make_random(1, 2);
  double mean_cosine = 0.0;
  constexpr int count = 20'000;
  for (int i = 0; i < count; ++i) {
    const Vec2f u{static_cast<float>(random.uniform()), static_cast<float>(random.uniform())};
    const ShiningPoint point = sample_ball(center, radius, from, *seen, u);
    EXPECT_NEAR(length(point.position - center), radius, 1e-4f);
    const Vec3f d = normalize(point.position - from);
    EXPECT_LE(dot(d, point.normal), 1e-3f);  // on the near side
    const auto met = meet_ball(center, radius, from, d);
    if (met) {
      EXPECT_NEAR(*met, length(point.position - from), 2e-2f);
    }
    mean_cosine += static_cast<double>(dot(d, normalize(center - from))) / count;
  }
  // Evenly over the cone: the mean of the cosine is the middle of its range.
  EXPECT_NEAR(mean_cosine, 1.0 - 0.5 * static_cast<double>(seen->one_minus_cos), 1e-3);
}

/// A square of emission above the white one, facing down.
Scene lit_by_a_square(float side, int samples) {
  Scene scene = white_square(samples);
  scene.materials.push_back(diffuse_material(0.0f));
  scene.materials[1].emission = {5, 5, 5};
  Mesh lamp = make_square(side, 1);
  for (Vec3f& p : lamp.positions) p = {p.y, p.x, 30.0f};  // turned over
  for (Vec3f& n : lamp.normals) n = {0, 0, -1};
  scene.meshes.push_back(lamp);
  scene.camera.position.z = 20.0;  // below the lamp
  return scene;
}

TEST(ShiningSurfaces, LightAsARectangleDoes) {
  using Direct = RenderOptions::DirectLight;
  for (const float side : {40.0f, 2.0f}) {
    const double a = 0.5 * static_cast<double>(side) / 30.0, r = std::sqrt(1.0 + a * a);
    const double factor = 4.0 / (2.0 * pi) * 2.0 * a / r * std::atan(a / r);
    const double expected = pi * 5.0 * factor;
    const Scene scene = lit_by_a_square(side, 1024);
    EXPECT_NEAR(irradiance(scene), expected, 0.015 * expected) << side;
    EXPECT_NEAR(irradiance(scene, {.direct_light = Direct::lights_only}), expected,
                0.02 * expected);
    if (side > 10.0f) {
      EXPECT_NEAR(irradiance(scene, {.direct_light = Direct::surfaces_only}), expected,
                  0.06 * expected);
    }
  }
}

TEST(ShiningSurfaces, AreDarkFromBehindAndSeenFromTheFront) {
  Scene scene = lit_by_a_square(40.0f, 4);
  for (Vec3f& n : scene.meshes[1].normals) n = {0, 0, 1};
  EXPECT_EQ(irradiance(scene), 0.0);
  scene = lit_by_a_square(40.0f, 4);
  scene.camera = {
      .position = {0, 0, 10}, .look_at = {0, 0, 30}, .up = {0, 1, 0}, .horizontal_fov = 0.1};
  EXPECT_NEAR(mean_of(render(scene).image, 0), 5.0, 1e-4);
}

// All that shines inside a closed white room of reflectance 1/2: radiance e + e/2 + e/4 + … = 2 e.
TEST(ShiningSurfaces, FillAClosedRoomWithTheSumOfAllBounces) {
  Scene scene;
  scene.materials = {diffuse_material(0.5f)};
  scene.materials[0].emission = {1, 1, 1};
  Mesh room = make_cube(10.0f);
  for (Vec3f& n : room.normals) n = -n;  // its inner side is outside
  scene.meshes = {room};
  scene.camera = {
      .position = {0, 0, 0}, .look_at = {1, 0.2, 0.1}, .up = {0, 0, 1}, .horizontal_fov = 1.0};
  scene.film = {.width = 8, .height = 8};
  scene.render = {.samples_per_pixel = 64, .max_bounces = 40};
  EXPECT_NEAR(mean_of(render(scene).image, 0), 2.0, 0.03);
}

// The sum over the views of a soft light is its irradiance.
TEST(LightViews, OfBallsSpotsAndSurfacesAddUpToTheirIrradiance) {
  Scene scene = lit_by_a_square(2.0f, 1);
  scene.lights = {SphereLight{.center = {0, 0, 40}, .radius = 2, .radiance = {3, 3, 3}},
                  spot_above(20.0, 10.0, 30.0)};
  const std::vector<LightView> views = make_light_views(scene, 4096, 1);
  double of_ball = 0.0, of_spot = 0.0, of_surface = 0.0;
  for (const LightView& view : views) {
    const IncidentLight light = incident_light({0, 0, 0}, view);
    const double value =
        static_cast<double>(light.irradiance * view.strength.x * std::max(light.direction.z, 0.0f));
    const bool is_spot = dot(view.cone_axis, view.cone_axis) > 0.0f;
    (is_spot ? of_spot : view.where.z < 31.0f ? of_surface : of_ball) += value;
  }
  EXPECT_NEAR(of_ball, pi * 3.0 * 4.0 / 1600.0, 0.005 * of_ball);
  EXPECT_NEAR(of_surface, 5.0 * 4.0 / 900.0, 0.005 * of_surface);
  EXPECT_NEAR(of_spot, 0.4 * static_cast<double>(spot_share(0.9396926f, 0.9848078f, 0.8660254f)),
              1e-4);
}

}  // namespace
}  // namespace lamina

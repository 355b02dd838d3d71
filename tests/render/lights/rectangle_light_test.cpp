// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "lamina/render/lights/lights.h"
#include "lamina/scene/description/scene.h"

namespace lamina {
namespace {

/// Irradiance of a polygon of radiance 1, all of it above the horizon: half the sum over its edges
/// of the angle that each is seen under times the cosine between the normals of the receiver and of
/// the plane through the edge. Source: [Howell2010] §4.3.3.1, by a contour integral.
double irradiance_of_polygon(const std::vector<Vec3>& corners, const Vec3& from,
                             const Vec3& normal) {
  double sum = 0.0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec3 a = normalize(corners[i] - from);
    const Vec3 b = normalize(corners[(i + 1) % corners.size()] - from);
    const Vec3 across = cross(a, b);
    const double sine = length(across);
    sum += 0.5 * std::atan2(sine, dot(a, b)) * dot(across, normal) / sine;
  }
  return std::abs(sum);
}

// From below, from aside, close by, at the height of a corner, and far away where the area counts.
TEST(RectangleLight, GivesTheIrradianceOfItsContour) {
  Scene scene;
  const Vec3 u{30, 0, 0}, v{0, 40, 0}, center{5, -3, 50};
  scene.lights = {RectangleLight{
      .center = center, .edge_u = v, .edge_v = u, .radiance = {1, 1, 1}}};  // shines down
  const Lights lights(scene, {-1, -1, -1}, {1, 1, 1});
  const std::vector<Vec3> corners = {center - 0.5 * (u + v), center + 0.5 * (u - v),
                                     center + 0.5 * (u + v), center - 0.5 * (u - v)};
  const std::array<Vec3, 6> places = {Vec3{0, 0, 0},    Vec3{60, 10, 0},     Vec3{5, -3, 49},
                                      Vec3{20, 17, 30}, Vec3{-100, 200, 45}, Vec3{0, 0, -3000}};
  for (const Vec3& place : places) {
    double irradiance = 0.0, solid_angle = 0.0;
    constexpr int strata = 96;
    for (int i = 0; i < strata * strata; ++i) {
      const Vec2f at{(static_cast<float>(i % strata) + 0.5f) / strata,
                     (static_cast<float>(i / strata) + 0.5f) / strata};
      const LightSample sample = lights.sample_light(
          {static_cast<float>(place.x), static_cast<float>(place.y), static_cast<float>(place.z)},
          0.5f, at);
      ASSERT_GT(sample.pdf, 0.0f);
      const double weight = 1.0 / (static_cast<double>(sample.pdf) * strata * strata);
      irradiance += weight * static_cast<double>(sample.direction.z * sample.radiance.x);
      solid_angle += weight;
      EXPECT_NEAR(place.z + static_cast<double>(sample.direction.z * sample.distance), center.z,
                  1e-3 * length(center - place));
    }
    const double expected = irradiance_of_polygon(corners, place, {0, 0, 1});
    EXPECT_NEAR(irradiance / expected, 1.0, 1e-3) << place.x << ' ' << place.y << ' ' << place.z;
    // Oosterom and Strackee's formula for two triangles.
    double expected_angle = 0.0;
    for (const std::size_t k : {1u, 2u}) {
      const Vec3 a = normalize(corners[0] - place), b = normalize(corners[k] - place),
                 c = normalize(corners[k + 1] - place);
      expected_angle +=
          2.0 * std::atan2(std::abs(dot(a, cross(b, c))), 1.0 + dot(a, b) + dot(b, c) + dot(c, a));
    }
    EXPECT_NEAR(solid_angle / expected_angle, 1.0, 1e-3);
  }
}

// A lamp a thousand times as dim as another is drawn often enough to be found where the other is
// hidden, and both give the irradiance that they should.
TEST(RectangleLight, IsDrawnBesideAMuchBrighterOne) {
  Scene scene;
  const auto lamp = [](double side, float radiance) {
    return RectangleLight{.center = {side, 0, 50},
                          .edge_u = {0, 4, 0},
                          .edge_v = {4, 0, 0},
                          .radiance = {radiance, radiance, radiance}};
  };
  scene.lights = {lamp(-20, 1000), lamp(20, 1)};
  const Lights lights(scene, {-1, -1, -1}, {1, 1, 1});
  double irradiance[2] = {}, share[2] = {};
  constexpr int count = 4000;
  for (int i = 0; i < count; ++i) {
    const float u = (static_cast<float>(i) + 0.5f) / count;
    const LightSample sample = lights.sample_light({0, 0, 0}, u, {0.5f, 0.5f});
    const std::size_t which = sample.direction.x < 0.0f ? 0 : 1;
    share[which] += 1.0 / count;
    irradiance[which] +=
        static_cast<double>(sample.direction.z * sample.radiance.x / sample.pdf) / count;
    EXPECT_NEAR(lights.pdf_of_area_light({0, 0, 0}, sample.direction, sample.distance), sample.pdf,
                1e-3f * sample.pdf);
  }
  EXPECT_GT(share[1], 0.12);
  EXPECT_NEAR(irradiance[0] / irradiance[1], 1000.0, 5.0);
}

}  // namespace
}  // namespace lamina

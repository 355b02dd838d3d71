// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "lamina/base/core/random.h"
#include "lamina/layers/optics/rough/gaussian_surface.h"
#include "lamina/layers/optics/rough/multiple_scattering.h"
#include "render/small_scenes.h"

namespace lamina {
namespace {

constexpr double degree = std::numbers::pi / 180.0;
constexpr double azimuth = 2.7;  // of the eye; the light's is 0
constexpr std::array models = {FacetScattering::single, FacetScattering::multiple,
                               FacetScattering::xu_sun};

Vec3 direction(double theta, double phi = 0.0) {
  return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}

/// The face of a half-space of index `ior` below z = 0, seen from above at an angle.
Scene rough_face(float ior, float smoothness, FacetScattering scattering, double theta_o,
                 int samples) {
  Scene scene;
  scene.camera = camera_above(0.01);
  scene.camera.position = 10.0 * direction(theta_o, azimuth);
  scene.camera.horizontal_fov = 1e-4;
  scene.film = {.width = 4, .height = 4};
  scene.render = {.samples_per_pixel = samples, .max_bounces = 0};
  scene.materials = {
      {.name = "glass",
       .surface = DielectricSurface{
           .ior = ior, .smoothness = ScalarParameter{smoothness, {}}, .scattering = scattering}}};
  scene.meshes = {make_square(100.0f)};
  return scene;
}

/// Radiance per irradiance that the face sends up to theta_o of light from theta_i below.
double expected_btdf(float ior, double smoothness, FacetScattering scattering, double theta_i,
                     double theta_o) {
  const GaussianSurface surface{smoothness, 1.0 / static_cast<double>(ior)};
  const Vec3 wi = direction(theta_i), up = direction(theta_o, azimuth);
  const Vec3 wo{up.x, up.y, -up.z};  // seen from below
  switch (scattering) {
    case FacetScattering::xu_sun:
      return single_scattering_btdf(surface, wi, wo);
    case FacetScattering::single:
      return btdf(make_rough_interface(surface), wi, wo);
    default: {
      Random random = make_random(3, 0);
      double sum = 0.0;
      constexpr int walks = 200'000;
      for (int i = 0; i < walks; ++i)
        sum += evaluate_multiple_scattering(make_rough_interface(surface), wi, wo, random);
      return sum / walks;
    }
  }
}

// The lights of [XuSun2008] Figures 10 and 11: one that is far and one that is near, both inside.
TEST(RoughDielectric, ShowsALightInsideAsTheBtdfOfLightThatLeaves) {
  for (const FacetScattering scattering : models)
    for (const float ior : {1.4f, 1.0f / 1.4f})
      for (const float s : {3.0f, 1.0f}) {
        const double theta_i = 20.0 * degree, theta_o = 25.0 * degree;
        const bool is_random = scattering == FacetScattering::multiple;
        Scene scene = rough_face(ior, s, scattering, theta_o, is_random ? 1024 : 4);
        const Vec3 below = Vec3{direction(theta_i).x, 0.0, -direction(theta_i).z};
        const double expected = expected_btdf(ior, s, scattering, theta_i, theta_o);
        const double tolerance = is_random ? 0.03 : 1e-3;  // the camera's angles in float
        scene.lights = {DirectionalLight{.direction = below, .irradiance = {2, 2, 2}}};
        EXPECT_NEAR(mean_of(render(scene).image, 0) / (2.0 * std::cos(theta_i) * expected), 1.0,
                    tolerance)
            << "far, ior " << ior << " s " << s << " model " << static_cast<int>(scattering);
        scene.lights = {PointLight{.position = 40.0 * below, .intensity = {500, 500, 500}}};
        EXPECT_NEAR(
            mean_of(render(scene).image, 0) / (500.0 / 1600.0 * std::cos(theta_i) * expected), 1.0,
            tolerance)
            << "near, ior " << ior << " s " << s << " model " << static_cast<int>(scattering);
      }
}

// Even light of radiance 1 on both sides of a face: the eye sees R + T / n^2 of it, in which the
// light inside has a smaller radiance than glass in equilibrium would hold.
TEST(RoughDielectric, CountsRadianceInsideTheGlassAsItIs) {
  const float ior = 1.5f;
  Scene scene = rough_face(ior, 1e4f, FacetScattering::single, 0.0, 4096);
  scene.lights = {EnvironmentLight{}};
  const double r = std::pow(0.5 / 2.5, 2);
  EXPECT_NEAR(mean_of(render(scene).image, 0), r + (1.0 - r) / (1.5 * 1.5), 2e-3);
}

TEST(RoughDielectric, ABallWithoutAbsorptionDisappearsInEvenLight) {
  Scene scene = rough_face(1.5f, 1.0f, FacetScattering::multiple, 0.3, 512);
  scene.meshes = {make_sphere(4.0f)};
  scene.lights = {EnvironmentLight{}};
  EXPECT_NEAR(
      mean_of(render(scene, {.direct_light = RenderOptions::DirectLight::surfaces_only}).image, 0),
      1.0, 2e-3);
  EXPECT_NEAR(mean_of(render(scene).image, 0), 1.0, 0.01);
}

// A lamp behind a frosted pane, which has two faces.
TEST(RoughDielectric, FindsALampByItsLightAndByItsSurfacesAlike) {
  for (const FacetScattering scattering : models) {
    Scene scene = rough_face(1.5f, 2.0f, scattering, 0.2, 2048);
    Mesh back = make_square(100.0f);
    for (Vec3f& p : back.positions) p.z = -3.0f;
    for (Vec3f& n : back.normals) n = -n;
    for (auto& t : back.triangles) std::swap(t[1], t[2]);
    scene.meshes.push_back(back);
    scene.lights = {RectangleLight{
        .center = {0, 0, -20}, .edge_u = {16, 0, 0}, .edge_v = {0, 16, 0}, .radiance = {3, 3, 3}}};
    using DirectLight = RenderOptions::DirectLight;
    const auto seen = [&](DirectLight by) {
      return mean_of(render(scene, {.direct_light = by}).image, 0);
    };
    const double combined = seen(DirectLight::combined);
    EXPECT_GT(combined, 0.1);
    EXPECT_NEAR(seen(DirectLight::surfaces_only) / combined, 1.0, 0.05);
    EXPECT_NEAR(seen(DirectLight::lights_only) / combined, 1.0, 0.05);
  }
}

// Light on a surface inside glass counts the same, whichever way it is found.
TEST(RoughDielectric, LightsWhatLiesInsideGlassTheSameByEitherSampling) {
  Scene scene = rough_face(1.5f, 1e4f, FacetScattering::single, 0.0, 1024);
  scene.materials.push_back(diffuse_material(0.8f));
  scene.meshes = {make_sphere(4.0f, 24, 0), make_sphere(2.0f, 24, 1)};
  scene.lights = {EnvironmentLight{}};
  using DirectLight = RenderOptions::DirectLight;
  const auto seen = [&](DirectLight by) {
    return mean_of(render(scene, {.direct_light = by}).image, 0);
  };
  EXPECT_NEAR(seen(DirectLight::surfaces_only), seen(DirectLight::lights_only), 0.01);
}

}  // namespace
}  // namespace lamina

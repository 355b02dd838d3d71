// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "lamina/base/core/random.h"
#include "lamina/render/lights/internal/environment.h"
#include "lamina/render/lights/light_views.h"
#include "lamina/render/subsurface/papers/shadow_map/internal/shadow_buffer.h"
#include "lamina/render/subsurface/profiles/profile_maker.h"
#include "lamina/scene/description/studio_environment.h"
#include "render/small_scenes.h"

namespace lamina {
namespace {

constexpr float pi_f = std::numbers::pi_v<float>;

/// A mesh of the material, seen from above.
Scene scene_of(Mesh mesh, Material material, Light light) {
  Scene scene = translucent_scene(RenderSettings::Method::shadow_map, std::move(mesh),
                                  std::move(material), std::move(light));
  scene.film = {.width = 8, .height = 8};
  scene.render.samples_per_pixel = 16;
  return scene;
}

DirectionalLight sun(const Vec3& towards) {
  return {.direction = normalize(towards), .irradiance = {pi_f, pi_f, pi_f}};
}

// What a grid says about a point is what its rays say: the ray of the texel passes by no further
// than half a diagonal. Lights far away, near, and within the box.
TEST(ShadowGrid, RaysGoWherePointsAreFound) {
  Random random(5);
  const Vec3f low{-3, -4, -5}, high{3, 4, 5};
  for (const LightView& view :
       {LightView{.where = normalize(Vec3f{1, -2, 3}), .is_far = true},
        LightView{.where = {0, 0, 1}, .is_far = true}, LightView{.where = {9, -2, 4}},
        LightView{.where = {3.5f, 0, 0}}, LightView{.where = {1, 0.5f, -2}}}) {
    const ShadowGrid grid(view, low, high, 64 * 64);
    EXPECT_NEAR(static_cast<double>(grid.size()), 64.0 * 64.0, 64.0);
    for (int i = 0; i < 500; ++i) {
      const Vec3f p{6.0f * (random.uniform_float() - 0.5f), 8.0f * (random.uniform_float() - 0.5f),
                    10.0f * (random.uniform_float() - 0.5f)};
      const ShadowGrid::Place place = grid.find(p);
      ASSERT_LT(place.texel, grid.size());
      EXPECT_LT(length(grid.origin() + place.ray.origin + place.distance * place.ray.direction - p),
                1e-4f);
      const Ray ray = grid.ray(place.texel);
      const Vec3f offset = p - ray.origin;
      const float along = dot(offset, ray.direction);
      const float aside = length(offset - along * ray.direction);
      // The equal-area map stretches texels towards directions opposite to the middle.
      EXPECT_TRUE(along <= 0.0f || aside < 4.0f * grid.width(place.distance)) << i;
    }
  }
}

TEST(LightViews, AddUpToTheLight) {
  Scene scene;
  scene.lights = {RectangleLight{
      .center = {0, 0, 5}, .edge_u = {0, 4, 0}, .edge_v = {4, 0, 0}, .radiance = {2, 2, 2}}};
  double irradiance = 0.0;
  for (const LightView& view : make_light_views(scene, 64, 1)) {
    const IncidentLight from = incident_light({0, 0, 0}, view);
    irradiance += static_cast<double>(from.irradiance * from.direction.z * view.strength.x);
  }
  // A square of half-width a at height h: 4 a / sqrt(a² + h²) atan(a / sqrt(a² + h²)) per radiance.
  const double s = std::sqrt(4.0 + 25.0);
  EXPECT_NEAR(irradiance, 2.0 * 4.0 * 2.0 / s * std::atan(2.0 / s), 2e-3 * irradiance);
  EXPECT_EQ(incident_light({0, 0, 9}, make_light_views(scene, 1, 1)[0]).irradiance, 0.0f);

  scene.images = {make_studio_environment(64)};
  scene.lights = {EnvironmentLight{.image = 0}};
  Vec3f total{};
  for (const LightView& view : make_light_views(scene, 1, 1024)) total += view.strength;
  const Vec3f mean = Environment(scene.images[0], {1, 1, 1}, 0.0f).mean_radiance();
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(total[c], 4.0f * pi_f * mean[c], 0.02f * total[c]);
}

// Even light on a flat half-space: irradiance times what the half-space reflects, from any side.
TEST(ShadowMap, ReturnsTheAlbedoOfAFlatHalfSpace) {
  const Material material = half_space({0.05, 0.3, 2.0}, 10.0, 1.0);
  const Profile profile = diffusion_profile(material);
  for (const Vec3& towards : {Vec3{0, 0, 1}, Vec3{2, 1, 1}}) {
    const Image image = render(scene_of(make_square(40.0f), material, sun(towards))).image;
    const double cos_i = normalize(towards).z;
    for (std::size_t c = 0; c < 3; ++c)
      EXPECT_NEAR(mean_of(image, c), cos_i * profile.total_reflectance[c],
                  0.01 * cos_i * profile.total_reflectance[c])
          << c;
  }
}

TEST(ShadowMap, DomeOfLightsIsAnEvenSky) {
  const Material material = half_space({0.05, 0.3, 2.0}, 10.0, 1.0);
  const Profile profile = diffusion_profile(material);
  const Image image = render(scene_of(make_square(40.0f), material, EnvironmentLight{})).image;
  for (std::size_t c = 0; c < 3; ++c)
    EXPECT_NEAR(mean_of(image, c), profile.total_reflectance[c],
                0.02 * profile.total_reflectance[c])
        << c;
}

TEST(ShadowMap, InvertedColorIsTheReflectanceThatComesOut) {
  Scene scene =
      scene_of(make_square(30.0f), half_space({0.05, 0.3, 2.0}, 10.0, 1.0), sun({0, 1, 1}));
  auto& surface = std::get<SubsurfaceSurface>(scene.materials[0].surface);
  surface.color_use = SubsurfaceSurface::ColorUse::invert;
  surface.color.value = {0.7f, 0.4f, 0.1f};
  const Image image = render(scene).image;
  const double expected[3] = {0.7, 0.4, 0.1};
  for (std::size_t c = 0; c < 3; ++c)
    EXPECT_NEAR(mean_of(image, c), std::sqrt(0.5) * expected[c], 0.015 * expected[c]) << c;
}

/// Largest difference of two pictures' smooth parts, over the mean of the second.
double difference(const Image& a, const Image& b, std::size_t c) {
  double worst = 0.0;
  constexpr int block = 6;
  for (int y = 0; y < a.height; y += block)
    for (int x = 0; x < a.width; x += block) {
      double d = 0.0;
      for (int j = 0; j < block; ++j)
        for (int i = 0; i < block; ++i)
          d += static_cast<double>(a.at(x + i, y + j)[c] - b.at(x + i, y + j)[c]);
      worst = std::max(worst, std::abs(d) / (block * block));
    }
  return worst / mean_of(b, c);
}

// Two ways to the same integral. Lit from the side by every kind of light, so that light is seen
// beyond the terminator and through the thin end of an egg.
TEST(ShadowMap, GivesThePictureOfTheProfileMethods) {
  Mesh egg = make_sphere(3.0f, 32);
  for (Vec3f& p : egg.positions) p.z *= 0.4f;
  for (Vec3f& n : egg.normals) n = normalize(Vec3f{n.x, n.y, n.z / 0.4f});
  for (const Light& light :
       {Light{sun({1, 0.3, 0.2})}, Light{PointLight{.position = {5, 3, 1}, .intensity = {9, 9, 9}}},
        Light{RectangleLight{.center = {8, 0, 3},
        .edge_u = {0, 4, 0},
        .edge_v = {3, 0, -8},
        .radiance = {10, 10, 10}}},
        Light{EnvironmentLight{}}}) {
    Scene scene = scene_of(egg, half_space({0.02, 0.1, 0.5}, 4.0, 1.3), light);
    scene.camera = camera_above(5.0);
    scene.film = {.width = 18, .height = 18};
    const Image drawn = render(scene).image;
    scene.render.method = RenderSettings::Method::hierarchy;
    scene.render.hierarchy.irradiance_samples = 8;
    scene.render.samples_per_pixel = 8;
    const Image summed = render(scene).image;
    for (std::size_t c = 0; c < 3; ++c) {
      EXPECT_NEAR(mean_of(drawn, c), mean_of(summed, c), 0.02 * mean_of(summed, c))
          << light.index() << ' ' << c;
      EXPECT_LT(difference(drawn, summed, c), 0.08) << light.index() << ' ' << c;
    }
  }
}

// Light on x > 0 only, in the shadow of a knife that is not seen by the buffer itself: the flux
// that leaves at x is the profile over the lit half.
TEST(ShadowMap, LightSpreadsUnderAShadowEdgeAsTheProfileSays) {
  const Material material = half_space({0.05, 0.2, 1.0}, 4.0, 1.0);
  Scene scene = scene_of(make_square(60.0f), material, sun({0, 0, 1}));
  Mesh knife = make_square(60.0f, 1);
  for (Vec3f& p : knife.positions) p = p + Vec3f{-30.0f, 0.0f, 5.0f};
  scene.meshes.push_back(knife);
  scene.materials.push_back(diffuse_material(0.0f));
  scene.camera = {
      .position = {40, 0, 4}, .look_at = {0, 0, 0}, .up = {0, 0, 1}, .horizontal_fov = 2e-5};
  scene.film = {.width = 1, .height = 1};
  scene.render.samples_per_pixel = 4096;
  const Profile profile = diffusion_profile(material);
  for (const double x : {-0.5, 0.0, 1.0}) {
    scene.camera.look_at = {x, 0, 0};
    const Image image = render(scene).image;
    for (std::size_t c = 0; c < 3; ++c) {
      double dark = 0.0;
      const double all = profile.total_reflectance[c];
      for (std::size_t i = 0; i + 1 < profile.r.size(); ++i) {
        const double r = std::sqrt(profile.r[i] * profile.r[i + 1]);
        const double ring =
            std::numbers::pi * (profile.r[i + 1] * profile.r[i + 1] - profile.r[i] * profile.r[i]) *
            std::sqrt(profile.reflectance_at(i, c) * profile.reflectance_at(i + 1, c));
        if (r > std::abs(x)) dark += ring * std::acos(std::abs(x) / r) / std::numbers::pi;
      }
      EXPECT_NEAR(mean_of(image, c), x < 0.0 ? dark : all - dark, 0.015 * all) << x << ' ' << c;
    }
  }
}

// A ball inside stops light from behind, black or white, and none that comes from the front.
TEST(ShadowMap, OpaqueObjectsInsideStopLightFromBehind) {
  const auto brightness = [](double side, float reflectance, float aside) {
    Scene scene = scene_of(make_sphere(6.0f, 24), half_space({0.02, 0.02, 0.02}, 1.0, 1.3),
                           sun({0.1, 0.05, side}));
    scene.camera = camera_above(3.0);
    scene.materials.push_back(diffuse_material(reflectance));
    Mesh ball = make_sphere(4.0f, 16, 1);
    for (Vec3f& p : ball.positions) p.x += aside;
    scene.meshes.push_back(ball);
    return mean_of(render(scene).image, 1);
  };
  const double through = brightness(-1.0, 0.0f, 40.0f), reflected = brightness(1.0, 0.0f, 40.0f);
  EXPECT_GT(through, 1e-4);
  EXPECT_LT(brightness(-1.0, 0.0f, 0.0f), 0.8 * through);
  EXPECT_LT(brightness(-1.0, 1.0f, 0.0f), 0.8 * through);
  EXPECT_GT(brightness(-1.0, 0.0f, 0.0f), 0.01 * through);
  EXPECT_NEAR(brightness(1.0, 0.0f, 0.0f), reflected, 0.01 * reflected);
}

}  // namespace
}  // namespace lamina

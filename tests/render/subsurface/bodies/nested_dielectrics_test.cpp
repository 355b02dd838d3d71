// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/bodies/nested_dielectrics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "lamina/base/core/error.h"
#include "lamina/layers/materials/material.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling_bsdf.h"
#include "render/small_scenes.h"

namespace lamina {
namespace {

/// Equal in all bands, so that they share all paths.
Material medium(double sigma_a, double sigma_s, double ior) {
  return material_of(
      {layer_of({sigma_a, sigma_a, sigma_a}, {sigma_s, sigma_s, sigma_s}, 0.3, infinite, ior)});
}

Mesh with_material(Mesh mesh, std::uint32_t material) {
  mesh.is_closed = true;
  mesh.material.assign(mesh.triangles.size(), material);
  return mesh;
}

Mesh moved(Mesh mesh, const Vec3f& by) {
  for (Vec3f& p : mesh.positions) p += by;
  return mesh;
}

Scene scene_of(std::vector<Mesh> meshes, const std::vector<Material>& media, Light light,
               int samples) {
  Scene scene = translucent_scene(RenderSettings::Method::random_walk, meshes[0], media[0], light);
  for (std::size_t i = 1; i < media.size(); ++i)
    scene.materials.push_back(
        {.name = "other", .surface = SubsurfaceSurface{.material = media[i]}});
  scene.meshes = std::move(meshes);
  scene.film = {.width = 8, .height = 8};
  scene.render.samples_per_pixel = samples;
  return scene;
}

double mean_inside(const Scene& scene) {
  const Image image = render(scene).image;
  return mean_of(image, channel_index(image, "subsurface.G").value());
}

/// Two plates, one under the other; the lower one begins at a depth.
std::vector<Mesh> two_plates(float thickness, float depth, std::uint32_t lower_material) {
  return {make_plate(60.0f, thickness),
          with_material(moved(make_plate(60.0f, 10.0f), {0, 0, -depth}), lower_material)};
}

TEST(NestedDielectrics, InnerOneHasPriorityAndCoincidingFacesAreOne) {
  const Scene scene =
      scene_of({with_material(make_sphere(3.0f), 0), with_material(make_sphere(1.0f), 1),
                with_material(make_sphere(1.0f), 0)},
               {medium(0, 1, 1.4), medium(0, 1, 1.4)}, EnvironmentLight{}, 1);
  const RenderScene prepared(scene);
  const NestedDielectrics bodies(prepared);
  InteriorList interior;
  EXPECT_EQ(bodies.highest_priority(interior), NestedDielectrics::none);
  interior.add(0, 1);
  const Ray ray{{2, 0.1f, 0.2f}, {-1, 0, 0}};
  const Hit hit = prepared.geometry.first_hit(ray, 0.0f);
  const SurfacePoint point = make_bare_surface_point(scene.meshes, hit);
  const auto entry = bodies.cross(interior, point, ray.direction);
  EXPECT_FALSE(entry.is_blocked);
  EXPECT_EQ(entry.beyond.count, 3);
  EXPECT_EQ(bodies.highest_priority(entry.beyond), 2u);  // of the two that are equal the later
  const auto back = bodies.cross(entry.beyond, point, {1, 0, 0});
  EXPECT_EQ(back.beyond.count, 1);
  EXPECT_EQ(bodies.highest_priority(back.beyond), 0u);
}

// Light of the sky, and of a lamp that shines straight through the inner boundary.
TEST(NestedDielectrics, BallInABallOfTheSameMediumChangesNothing) {
  const Material flesh = medium(0.3, 2.0, 1.4);
  for (const bool is_sky : {true, false}) {
    const Light light =
        is_sky ? Light(EnvironmentLight{})
               : Light(DirectionalLight{.direction = {0.6, 0, 0.8}, .irradiance = {3, 3, 3}});
    const Mesh outer = with_material(make_sphere(2.0f), 0);
    const Mesh inner = with_material(moved(make_sphere(0.9f), {0.02f, 0.01f, 1.0f}), 1);
    const Scene with = scene_of({outer, inner}, {flesh, flesh}, light, 32);
    const Scene without = scene_of({outer}, {flesh}, light, 32);
    const double expected = mean_inside(without);
    EXPECT_NEAR(mean_inside(with), expected, 0.04 * expected) << is_sky;
  }
}

TEST(NestedDielectrics, TouchingAndOverlappingPlatesOfTwoIndicesReflectAsLayersDo) {
  const Material upper = medium(0.2, 4.0, 1.5), lower = medium(0.1, 2.0, 1.3);
  Material stack = upper;
  stack.layers[0].thickness = 0.3;
  stack.layers.push_back(lower.layers[0]);
  stack.layers[1].thickness = infinite;
  stack.ior_below = {1.3, 1.3, 1.3};
  const double expected = adding_doubling(layer_stack(stack, 0)).totals.diffuse_reflectance;
  for (const float depth : {0.3f, 0.2f}) {  // the thinner one fills where both are
    Scene scene = scene_of(two_plates(0.3f, depth, 1), {upper, lower}, EnvironmentLight{}, 96);
    scene.render.seed = 1;
    EXPECT_NEAR(mean_inside(scene), expected, 0.02 * expected) << depth;
  }
}

TEST(NestedDielectrics, PlatesThatTouchAreOneUnderALamp) {
  const Material material = medium(0.3, 2.0, 1.4);
  const double mu = 0.6, zero[] = {0.0};
  const Scene scene =
      scene_of(two_plates(0.3f, 0.3f, 0), {material},
               DirectionalLight{.direction = {0.8, 0, mu}, .irradiance = {1, 1, 1}}, 64);
  const double expected =
      mu * stack_bsdf(layer_stack(material, 0), std::acos(mu), zero, zero).brdf[0];
  EXPECT_NEAR(mean_inside(scene), expected, 0.015 * expected);
}

// A rough body of another index, a ball of glass and one that pokes out, none of which absorbs.
TEST(NestedDielectrics, WhiteBodiesInEvenLightAreInvisible) {
  Material rough = medium(0.0, 3.0, 1.7);
  rough.layers[0].top = {.roughness = 0.3, .distribution = MicrofacetDistribution::ggx};
  Scene scene = scene_of({with_material(make_sphere(2.0f), 0),
                          with_material(moved(make_sphere(0.6f), {-0.7f, 0, 1.0f}), 1),
                          with_material(moved(make_sphere(0.5f), {0.7f, 0, 1.2f}), 2),
                          with_material(moved(make_sphere(0.6f), {0, 0.8f, 1.6f}), 0)},
                         {medium(0.0, 1.0, 1.4), rough}, EnvironmentLight{}, 64);
  scene.materials.push_back({.name = "glass", .surface = DielectricSurface{.ior = 1.5f}});
  scene.camera = camera_above(2.6);
  EXPECT_NEAR(mean_of(render(scene).image, 1), 1.0, 0.008);
}

// Glass within flesh is the same glass as anywhere: with its map of roughness, and its model of
// facets, of which "single" loses the light that meets another.
TEST(NestedDielectrics, GlassInsideHasItsOwnRoughnessMapAndFacets) {
  const auto picture = [](const DielectricSurface& glass) {
    Scene scene = scene_of({with_material(make_sphere(1.0f), 0),
                            with_material(moved(make_sphere(0.6f), {0, 0, 0.2f}), 1)},
                           {medium(0.0, 1.0, 1.4)}, EnvironmentLight{}, 16);
    scene.materials.push_back({.name = "glass", .surface = glass});
    return render(scene).image;
  };
  DielectricSurface glass{
      .ior = 1.9f, .roughness = {.value = 0.8f}, .scattering = FacetScattering::multiple};
  const Image all_facets = picture(glass);
  EXPECT_NEAR(mean_of(all_facets, 1), 1.0, 0.01);

  DielectricSurface mapped = glass;
  mapped.roughness = {.map = TextureMap{.source = NoiseMap{}, .scale = 0.0f, .offset = 0.8f}};
  EXPECT_EQ(picture(mapped).pixels, all_facets.pixels);
  mapped.roughness.map->offset = 0.2f;
  EXPECT_NE(picture(mapped).pixels, all_facets.pixels);

  glass.scattering = FacetScattering::single;
  EXPECT_LT(mean_of(picture(glass), 1), 0.97);
}

TEST(NestedDielectrics, RefuseTwoMediaInsideOneMesh) {
  Mesh mesh = with_material(make_sphere(1.0f), 0);
  mesh.material.back() = 1;
  const Material material = medium(0.1, 1.0, 1.4);
  const Scene scene = scene_of({mesh, with_material(moved(make_sphere(1.0f), {1, 0, 0}), 1)},
                               {material, material}, EnvironmentLight{}, 1);
  EXPECT_THROW((void)render(scene), InvalidInput);
}

}  // namespace
}  // namespace lamina

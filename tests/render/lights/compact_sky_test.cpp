// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// A bright square in a dark environment image is a light like others: distant lights in its place,
// or a far rectangle, give the same picture, whatever carries the light below the surface.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <string>
#include <variant>
#include <vector>

#include "lamina/base/core/vec.h"
#include "lamina/layers/materials/material.h"
#include "lamina/layers/optics/fresnel.h"
#include "lamina/render/paths/path_tracer.h"
#include "render/small_scenes.h"

namespace lamina {
namespace {

constexpr double pi = std::numbers::pi;
constexpr int width = 256, height = 128;  // of the map
constexpr int middle_column = 230, middle_row = 64;

/// Towards a place of the map, in pixels from its upper left.
Vec3 direction_of(double x, double y) {
  const double theta = pi * y / height, phi = 2.0 * pi * (x / width - 0.5);
  return {std::sin(theta) * std::sin(phi), std::cos(theta), -std::sin(theta) * std::cos(phi)};
}

double solid_angle_of_pixel(double y) {
  return std::sin(pi * (y + 0.5) / height) * (pi / height) * (2.0 * pi / width);
}

/// A square of so many pixels on the horizon, 0.64 rad from +z, and its radiance: together 1 W/m2
/// on a facing surface.
struct Square {
  int size;
  [[nodiscard]] int left() const { return middle_column - size / 2; }
  [[nodiscard]] int top() const { return middle_row - size / 2; }
  [[nodiscard]] double radiance() const {
    double whole = 0.0;
    for (int y = top(); y < top() + size; ++y) whole += size * solid_angle_of_pixel(y);
    return 1.0 / whole;
  }
};

void light_by_sky(Scene& scene, const Square& square) {
  Image map = make_image(width, height, {"R", "G", "B"});
  for (int y = square.top(); y < square.top() + square.size; ++y)
    for (int x = square.left(); x < square.left() + square.size; ++x)
      for (int c = 0; c < 3; ++c) map.at(x % width, y)[c] = static_cast<float>(square.radiance());
  scene.images = {std::move(map)};
  scene.lights = {EnvironmentLight{.image = 0}};
}

/// At most 8 x 8 of them.
void light_by_distant_lights(Scene& scene, const Square& square) {
  const int step = std::max(square.size / 8, 1);
  scene.lights.clear();
  for (int y = square.top(); y < square.top() + square.size; y += step)
    for (int x = square.left(); x < square.left() + square.size; x += step) {
      double whole = 0.0;
      for (int row = y; row < y + step; ++row)
        whole += step * square.radiance() * solid_angle_of_pixel(row);
      const auto e = static_cast<float>(whole);
      scene.lights.push_back(DirectionalLight{
          .direction = direction_of(x + 0.5 * step, y + 0.5 * step), .irradiance = {e, e, e}});
    }
}

void light_by_rectangle(Scene& scene, const Square& square) {
  constexpr double distance = 3000.0;
  const Vec3 to_light = direction_of(square.left() + 0.5 * square.size, middle_row);
  const Vec3 right = normalize(cross(Vec3{0, 1, 0}, to_light)), up = cross(to_light, right);
  const double side = 2.0 * distance * std::tan(0.5 * square.size * pi / height);
  // The solid angle of a square. Source: [Urena2013] Eq. 1 where it is seen from straight above.
  const double h2 = 0.25 * side * side / (distance * distance);
  const double solid_angle = 4.0 * std::atan(h2 / std::sqrt(1.0 + 2.0 * h2));
  const auto radiance = static_cast<float>(1.0 / solid_angle);
  scene.lights = {RectangleLight{.center = distance * to_light,
                                 .edge_u = side * up,
                                 .edge_v = side * right,
                                 .radiance = {radiance, radiance, radiance}}};
}

/// That absorbs blue most.
MaterialLayer reddish(double sigma_a, double sigma_s, double g, double ior, double thickness) {
  return layer_of({sigma_a, 3.0 * sigma_a, 10.0 * sigma_a}, {sigma_s, sigma_s, sigma_s}, g,
                  thickness, ior);
}

Material homogeneous(double ior, double g = 0.0, double roughness = 0.0) {
  Material material = material_of({reddish(0.05, 2.0, g, ior, infinite)});
  if (roughness > 0.0)
    material.layers[0].top = {.roughness = roughness, .distribution = MicrofacetDistribution::ggx};
  return material;
}

Material two_layers(double ior_above, double ior_below) {
  return material_of(
      {reddish(0.05, 6.0, 0.5, ior_above, 0.2), reddish(0.02, 2.0, 0.0, ior_below, infinite)});
}

/// The top of a ball, so small a part of it that all pixels see about the same.
Scene ball(Material material, float radius, int samples) {
  Mesh mesh = make_sphere(radius);
  mesh.is_closed = true;
  Scene scene = translucent_scene(RenderSettings::Method::random_walk, std::move(mesh),
                                  std::move(material), EnvironmentLight{});
  scene.camera = camera_above(0.1 * static_cast<double>(radius));
  scene.film = {.width = 8, .height = 8};
  scene.render.samples_per_pixel = samples;
  return scene;
}

struct Mean {
  double value, error;
};
/// Of what leaves the inside, by pixels that are independent of one another.
std::vector<Mean> means_inside(const Scene& scene) {
  const Image image = render(scene).image;
  const double pixels = image.width * image.height;
  std::vector<Mean> means;
  for (const char* name : {"subsurface.R", "subsurface.G", "subsurface.B"}) {
    const std::size_t channel = channel_index(image, name).value();
    double squares = 0.0;
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x)
        squares += std::pow(static_cast<double>(image.at(x, y)[channel]), 2);
    const double mean = mean_of(image, channel);
    means.push_back(
        {mean, std::sqrt(std::max(squares / pixels - mean * mean, 0.0) / (pixels - 1.0))});
  }
  return means;
}

/// As sky the light is the same as by other lights, within four standard errors, which are at most
/// `most_error` of it.
template <class LightIt>
void expect_same_as_sky(Scene scene, const Square& square, const LightIt& light_otherwise,
                        double most_error, const std::string& what) {
  light_otherwise(scene, square);
  const std::vector<Mean> expected = means_inside(scene);
  light_by_sky(scene, square);
  scene.render.seed = 1;
  const std::vector<Mean> found = means_inside(scene);
  for (std::size_t c = 0; c < 3; ++c) {
    const double error = std::hypot(found[c].error, expected[c].error);
    EXPECT_LT(error, most_error * expected[c].value) << what << ", channel " << c;
    EXPECT_NEAR(found[c].value, expected[c].value, 4.0 * error) << what << ", channel " << c;
  }
}

TEST(CompactSky, EntersAsDistantLightsDoWhateverItsSize) {
  for (const int size : {1, 8, 16, 64})
    expect_same_as_sky(ball(homogeneous(1.3, 0.3), 3.0f, 128), {size}, light_by_distant_lights,
                       0.015, std::to_string(size) + " pixels");
}

TEST(CompactSky, EntersAsAFarRectangleDoes) {
  expect_same_as_sky(ball(homogeneous(1.3), 3.0f, 128), {8}, light_by_rectangle, 0.015,
                     "rectangle");
}

TEST(CompactSky, EntersThroughEveryBoundary) {
  const Square square{8};
  expect_same_as_sky(ball(homogeneous(1.0), 2.0f, 128), square, light_by_distant_lights, 0.015,
                     "matched index");
  expect_same_as_sky(ball(homogeneous(1.0, 0.0, 0.4), 1.0f, 128), square, light_by_distant_lights,
                     0.015, "rough, matched index");
  expect_same_as_sky(ball(homogeneous(1.3, 0.0, 0.5), 1.0f, 192), square, light_by_distant_lights,
                     0.045, "rough");
}

TEST(CompactSky, EntersLayers) {
  const Square square{8};
  expect_same_as_sky(ball(two_layers(1.4, 1.4), 1.0f, 16), square, light_by_distant_lights, 0.04,
                     "one index");
  // Through a boundary between layers paths alone find it.
  expect_same_as_sky(ball(two_layers(1.3, 1.5), 1.0f, 16), {32}, light_by_rectangle, 0.07,
                     "two indices");
}

TEST(CompactSky, EntersABodyInABody) {
  Scene scene = ball(homogeneous(1.4), 2.0f, 32);
  Mesh inner = make_sphere(0.9f, 48, 1);
  for (Vec3f& p : inner.positions) p += Vec3f{0.02f, 0.01f, 1.0f};
  inner.is_closed = true;
  scene.materials.push_back({.name = "inner", .surface = SubsurfaceSurface{homogeneous(1.4)}});
  scene.meshes.push_back(std::move(inner));
  expect_same_as_sky(scene, {8}, light_by_distant_lights, 0.04, "ball in a ball");
}

// Light that is scattered once by the way to it, and what diffusion adds.
TEST(CompactSky, IsScatteredOnceAsDistantLightsAre) {
  for (const auto single :
       {RenderSettings::SingleScattering::straight, RenderSettings::SingleScattering::refracted}) {
    Scene scene = ball(homogeneous(1.4), 3.0f, 128);
    scene.render.method = RenderSettings::Method::probe;
    scene.render.single_scattering = single;
    for (const int size : {1, 8, 32})
      expect_same_as_sky(scene, {size}, light_by_distant_lights, 0.015, std::to_string(size));
  }
}

// These find the light where it enters the surface, all in their own way.
TEST(CompactSky, IsFoundByEveryMethod) {
  using Method = RenderSettings::Method;
  for (const Method method : {Method::probe, Method::hierarchy, Method::shadow_map,
                              Method::layered_bsdf, Method::texture_space}) {
    Material material = homogeneous(1.4);
    if (method == Method::texture_space)
      material = parse_material(
          R"({ "lamina": "material", "version": 1, "name": "skin", "length_unit": "mm",
               "bands": [450, 540, 640], "skin": { "constants": "calibrated_diffusion" } })",
          "test");
    Scene scene =
        translucent_scene(method, make_square(20.0f), std::move(material), EnvironmentLight{});
    scene.render.samples_per_pixel = 64;
    scene.render.hierarchy = {.spacing = 0.3f, .irradiance_samples = 8};
    scene.render.texture_space = {.texel = 0.35f, .irradiance_samples = 32};
    for (const int size : {1, 8}) {
      light_by_distant_lights(scene, {size});
      const std::vector<Mean> expected = means_inside(scene);
      light_by_sky(scene, {size});
      const std::vector<Mean> found = means_inside(scene);
      for (std::size_t c = 0; c < 3; ++c)
        EXPECT_NEAR(found[c].value, expected[c].value, 0.005 * expected[c].value)
            << method.name() << ", " << size << " pixels, channel " << c;
    }
  }
}

/// Radiance that a path from inside an object finds along a ray.
double arriving_radiance(const Scene& scene, const Ray& ray) {
  const RenderScene prepared(scene);
  const auto conversion =
      make_band_conversion<4>(BandSet::rgb(), make_band_weights(BandSet::rgb()));
  const std::vector<std::unique_ptr<SubsurfaceMethod<4>>> transports(scene.materials.size());
  const LayeredMaterials<4> layered(scene.materials.size());
  const ThinSheets<4> sheets = make_thin_sheets<4>(scene);
  const Coverings<4> coverings(scene.materials.size());
  const PathTracer<4> tracer({prepared, conversion, transports, layered, sheets, coverings, {}});
  constexpr int count = 1 << 16;
  double sum = 0.0;
  for (std::uint32_t i = 0; i < count; ++i) {
    PixelSamples samples(1, i, 0);
    sum += static_cast<double>(tracer.arriving_radiance(ray, samples)[1]);
  }
  return sum / count;
}

// What searches from inside find is left out where paths from there meet it, but not where it is
// mirrored: that way nothing else finds.
TEST(CompactSky, IsLeftToSearchesOnlyWhereTheyFindIt) {
  const Square square{64};
  Scene scene;
  scene.materials = {{.name = "glass", .surface = DielectricSurface{.ior = 2.0f}}};
  scene.meshes = {make_square(100.0f)};
  const Vec3 up = direction_of(middle_column, middle_row);
  const Vec3f to_light{static_cast<float>(up.x), 0.0f, static_cast<float>(up.z)};
  const Ray straight{{0, 0, 1}, to_light};
  const Ray mirrored{{0, 0, 1}, {to_light.x, 0.0f, -to_light.z}};
  const double reflected = fresnel(up.z, 2.0);

  light_by_rectangle(scene, square);
  const auto lamp = static_cast<double>(std::get<RectangleLight>(scene.lights[0]).radiance.x);
  EXPECT_EQ(arriving_radiance(scene, straight), 0.0);
  EXPECT_NEAR(arriving_radiance(scene, mirrored), reflected * lamp, 0.04 * reflected * lamp);

  light_by_sky(scene, square);
  const double sky = square.radiance();
  double sought = 0.0;
  RenderScene(scene).lights.for_lights_seen(
      straight, 0.0f, std::numeric_limits<float>::infinity(), false,
      [&](const LightSeen& seen) { sought += static_cast<double>(seen.next_event_share); });
  EXPECT_GT(sought, 0.2);
  EXPECT_LT(sought, 1.0);
  EXPECT_NEAR(arriving_radiance(scene, straight), (1.0 - sought) * sky, 1e-4 * sky);
  EXPECT_NEAR(arriving_radiance(scene, mirrored), reflected * sky, 0.04 * reflected * sky);
}

}  // namespace
}  // namespace lamina

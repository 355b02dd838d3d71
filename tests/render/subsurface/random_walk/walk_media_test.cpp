// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/random_walk/internal/walk_media.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "lamina/base/core/error.h"
#include "lamina/base/core/random.h"
#include "lamina/layers/materials/material.h"
#include "lamina/layers/optics/rough/multiple_scattering.h"
#include "lamina/render/shading/render_scene.h"
#include "lamina/render/subsurface/random_walk/random_walk.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling_bsdf.h"
#include "render/small_scenes.h"
#include "render/subsurface/random_walk/walk_means.h"

namespace lamina {
namespace {

/// A dense layer of 0.3 mm on a clearer half-space. Bands turn by different angles.
Material two_layers() {
  Material material = material_of({layer_of({0.3, 0.6, 2.0}, {6, 8, 10}, 0.5, 0.3),
                                   layer_of({0.1, 0.4, 0.8}, {2, 2, 2}, 0.0, infinite)});
  material.layers[0].g = {0.6, 0.5, 0.4};
  return material;
}

Scene scene_of(Mesh mesh, Material material, Light light, int samples) {
  mesh.is_closed = true;
  Scene scene = translucent_scene(RenderSettings::Method::random_walk, std::move(mesh),
                                  std::move(material), light);
  scene.film = {.width = 8, .height = 8};
  scene.render.samples_per_pixel = samples;
  return scene;
}

double mean_inside(const Image& image, std::size_t c) {
  return mean_of(image, channel_index(image, std::string("subsurface.") + "RGB"[c]).value());
}

/// Parts of a way through a ball, layers by depth.
std::vector<double> parts_in_ball(const Ray& way, double radius, const std::vector<double>& tops) {
  const double middle = -static_cast<double>(dot(way.origin, way.direction));
  const double off2 = static_cast<double>(dot(way.origin, way.origin)) - middle * middle;
  std::vector<double> inner;  // of the way within the ball below each top
  for (const double top : tops) {
    const double r = radius - top;
    const double half = std::sqrt(std::max(r * r - off2, 0.0));
    inner.push_back(std::max(middle + half, 0.0) - std::max(middle - half, 0.0));
  }
  std::vector<double> parts;
  for (std::size_t i = 0; i < tops.size(); ++i)
    parts.push_back(inner[i] - (i + 1 < tops.size() ? inner[i + 1] : 0.0));
  return parts;
}

TEST(DepthLayers, CutWaysThroughABallIntoTheChordsOfItsShells) {
  const float radius = 3.0f;
  const std::vector<Mesh> meshes = {make_sphere(radius, 96)};
  const RayGeometry geometry(meshes);
  const NodeLattice lattice({-3, -3, -3}, {3, 3, 3}, 0.2f, 1e5);
  const DepthLayers layers(geometry, meshes, 0, {.layers = {{0.1f}, {0.5f}}}, lattice, 0.005f);
  Random random(7);
  const auto number = [&] { return 2.0f * random.uniform_float() - 1.0f; };
  double error = 0.0;
  int ways = 0;
  for (int i = 0; i < 200; ++i) {
    const Vec3f origin = 1.7f * Vec3f{number(), number(), number()};
    const Vec3f direction = normalize(Vec3f{number(), number(), number()});
    const Hit hit = geometry.first_hit({origin, direction}, 0.0f);
    if (length(origin) > 2.99f || !hit.is_hit()) continue;
    std::vector<double> found(3);
    layers.for_parts(
        {origin, direction}, layers.at(origin), hit.distance,
        layers.at(origin + hit.distance * direction),
        [&](const DepthLayers::Place& place, float part) {
          found[place.layer] += static_cast<double>(part);
          return true;
        },
        [](std::size_t, const DepthLayers::Crossing&) { return true; });
    const std::vector<double> expected = parts_in_ball({origin, direction}, 3.0, {0.0, 0.1, 0.6});
    // Near the rim of a shell chords are sensitive to the facets, up to 0.0004 mm off.
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(found[k], expected[k], 0.12) << i << ' ' << k;
    EXPECT_NEAR(found[0] + found[1] + found[2], hit.distance, 1e-4f * hit.distance);
    error += std::abs(found[0] - expected[0]) + std::abs(found[1] - expected[1]);
    ++ways;
  }
  EXPECT_GT(ways, 150);
  EXPECT_LT(error / ways, 0.002);
}

/// As if half of a sky entered all over, which is known to no walk.
class EvenlyLit final : public LightGatherer<4> {
 public:
  BandValues<4> entering_irradiance(const SurfacePoint&, PixelSamples&) const override {
    return BandValues<4>::filled(1.5f);
  }
  BandValues<4> shadow_transmittance(const Ray&, float) const override {
    return BandValues<4>::filled(1.0f);
  }
  BandValues<4> arriving_radiance(const Ray&, PixelSamples&) const override { return {}; }
};

// What some walks learn of layers saves work and must not count: nothing of it, all of it, and
// twice as much light as there is give the same mean; also of layers that two boundaries hide.
TEST(WalkMedia, HaveTheSameMeanWhateverWalksLearn) {
  const Light lamp = RectangleLight{
      .center = {6, 0, 9}, .edge_u = {0, 4, 0}, .edge_v = {3.33, 0, -2.22}, .radiance = {5, 5, 5}};
  for (const bool has_two_indices : {false, true}) {
    Material material = two_layers();
    if (has_two_indices) material.layers[1].ior = material.ior_below = {1.45, 1.45, 1.45};
    Scene scene = scene_of(make_sphere(3.0f, 64), std::move(material), lamp, 1);
    const RenderScene prepared(scene);
    const auto conversion =
        make_band_conversion<4>(BandSet::rgb(), make_band_weights(BandSet::rgb()));
    std::vector<SurfacePoint> points;
    for (int i = 0; i < 64; ++i) {
      const Vec3f from{0.4f * static_cast<float>(i % 8) - 1.4f,
                       0.4f * static_cast<float>(i / 8) - 1.4f, 9};
      const Hit hit = prepared.geometry.first_hit({from, {0, 0, -1}}, 0.0f);
      if (hit.is_hit()) points.push_back(make_surface_point(scene.meshes, hit, 0.0f));
    }
    ASSERT_GT(points.size(), 40u);
    const SurfacePoint& point = points[27];
    const ExitPoint exit{point, boundary_at(prepared, point), point.normal.z, {0, 0, 1}};
    WalkMeans of[3];
    for (std::size_t kind = 0; kind < 3; ++kind) {
      RandomWalk<4> walk(make_walk_media<4>(prepared, conversion), 0);
      if (kind > 0) {
        ASSERT_TRUE(walk.learn_depth_radiance(points, EvenlyLit{}, {}, kind == 2 ? 2.0f : 1.0f));
      }
      of[kind] = walk_means(walk, exit, EvenlyLit{});
      for (std::size_t b = 0; b < 3; ++b) {
        EXPECT_LT(of[kind].error[b], 0.03 * of[kind].mean[b]) << kind << ' ' << b;
      }
    }
    for (std::size_t b = 0; b < 3; ++b) {
      EXPECT_LT(of[1].error[b], 0.95 * of[0].error[b]) << has_two_indices << b;
      for (const std::size_t kind : {1u, 2u})
        EXPECT_NEAR(of[kind].mean[b], of[0].mean[b],
                    3.5 * std::hypot(of[0].error[b], of[kind].error[b]))
            << has_two_indices << " kind " << kind << " band " << b;
    }
  }
}

// By reciprocity the radiance towards the eye under an even sky is the flux that a beam from the
// eye sends back.
TEST(WalkMedia, WidePlateOfLayersReflectsAsAddingDoublingHasIt) {
  const Material material = two_layers();
  const Scene scene = scene_of(make_plate(60.0f, 30.0f), material, EnvironmentLight{}, 384);
  const Image image = render(scene).image;
  for (std::size_t c = 0; c < 3; ++c) {
    const double expected = adding_doubling(layer_stack(material, c)).totals.diffuse_reflectance;
    EXPECT_NEAR(mean_inside(image, c), expected, 0.015 * expected) << c;
  }
}

// Light of a lamp through the boundary and the layers. The noise is .7 % (of six seeds).
TEST(WalkMedia, WidePlateOfLayersScattersALampAsAddingDoublingHasIt) {
  const Material material = two_layers();
  const double mu = 0.6, zero[] = {0.0};
  const Scene scene =
      scene_of(make_plate(60.0f, 30.0f), material,
               DirectionalLight{.direction = {0.8, 0, mu}, .irradiance = {1, 1, 1}}, 384);
  const Image image = render(scene).image;
  for (std::size_t c = 0; c < 3; ++c) {
    const double expected =
        mu * stack_bsdf(layer_stack(material, c), std::acos(mu), zero, zero).brdf[0];
    EXPECT_NEAR(mean_inside(image, c), expected, 0.015 * expected) << c;
  }
}

// Thin layers on a ball; what is known about the light beforehand is used for one layer only, so
// the two have little in common.
TEST(WalkMedia, LayersOfOneMediumAreOneLayer) {
  const std::vector<double> sigma_a = {0.5, 1.0, 2.0}, sigma_s = {3, 4, 5};
  const RectangleLight lamp{
      .center = {6, 0, 9}, .edge_u = {0, 4, 0}, .edge_v = {3.33, 0, -2.22}, .radiance = {5, 5, 5}};
  double mean[2][3];
  for (const std::size_t layers : {1u, 3u}) {
    std::vector<MaterialLayer> stack(layers, layer_of(sigma_a, sigma_s, 0.4, 0.1));
    for (MaterialLayer& layer : stack) layer.g = {0.6, 0.4, 0.2};
    stack.back().thickness = infinite;
    Scene scene = scene_of(make_sphere(2.0f), material_of(stack), lamp, 16);
    scene.camera = {.position = {40, 0, 40}, .up = {0, 1, 0}, .horizontal_fov = 0.01};
    const Image image = render(scene).image;
    for (std::size_t c = 0; c < 3; ++c) mean[layers > 1][c] = mean_inside(image, c);
  }
  for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(mean[1][c], mean[0][c], 0.04 * mean[0][c]) << c;
}

TEST(WalkMedia, WhiteLayersInEvenLightAreInvisible) {
  Scene scene = scene_of(make_sphere(3.0f),
                         material_of({layer_of({0, 0, 0}, {5, 5, 5}, 0.7, 0.2),
                                      layer_of({0, 0, 0}, {1, 1, 1}, 0.0, infinite)}),
                         EnvironmentLight{}, 8);
  scene.camera = camera_above(4.0);
  const Image image = render(scene).image;
  for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(mean_of(image, c), 1.0, 0.01) << c;
}

/// A half-space under facets, the same in all bands so that they share all paths.
Material rough_medium(double sigma_a, double alpha) {
  const std::vector<double> a(3, sigma_a), s(3, 2.0);
  Material material = material_of({layer_of(a, s, 0.3, infinite)});
  material.layers[0].top = {.roughness = alpha, .distribution = MicrofacetDistribution::ggx};
  return material;
}

TEST(WalkMedia, WhiteObjectWithARoughBoundaryIsInvisibleInEvenLight) {
  Scene scene = scene_of(make_sphere(1.0f), rough_medium(0.0, 0.4), EnvironmentLight{}, 24);
  scene.camera = camera_above(1.4);
  EXPECT_NEAR(mean_of(render(scene).image, 0), 1.0, 0.005);
}

// Of what has entered, the part that leaves again: the renderer's mirror is of V-shaped grooves.
TEST(WalkMedia, WidePlateWithARoughBoundaryReflectsAsAddingDoublingHasIt) {
  const Material material = rough_medium(0.1, 0.5);
  const Scene scene = scene_of(make_plate(60.0f, 30.0f), material, EnvironmentLight{}, 96);
  const SlabTotals totals = adding_doubling(layer_stack(material, 0)).totals;
  const RenderScene prepared(scene);
  const double mirrored = prepared.boundaries[0].own->at(0.5f, 1.0f);
  const double expected =
      totals.diffuse_reflectance * (1.0 - mirrored) / (1.0 - totals.specular_reflectance);
  EXPECT_NEAR(mean_inside(render(scene).image, 0), expected, 0.015 * expected);
}

/// The same in all bands, with a boundary between the layers.
Material layers_of_two_indices(double sigma_a, double roughness) {
  const std::vector<double> a(3, sigma_a), above(3, 4.0), below(3, 2.0);
  Material material =
      material_of({layer_of(a, above, 0.3, 0.3, 1.3), layer_of(a, below, 0.0, infinite, 1.6)});
  material.layers[1].top = {.roughness = roughness};
  return material;
}

/// What a wide plate scatters of a lamp in one direction, over what adding-doubling has of it.
double scattered_over_expected(const Material& material, int samples) {
  const double mu = 0.6, zero[] = {0.0};
  const Scene scene =
      scene_of(make_plate(60.0f, 30.0f), material,
               DirectionalLight{.direction = {0.8, 0, mu}, .irradiance = {1, 1, 1}}, samples);
  const RoughInterface<double> facets =
      make_rough_interface<double>(material.layers[0].top, 1.0, material.layers[0].ior[0]);
  Random random(3);
  double mirrored = 0.0;  // by any number of facets
  for (int i = 0; i < 20'000; ++i)
    mirrored += evaluate_multiple_scattering(facets, {0.8, 0, mu}, {0, 0, 1}, random) / 20'000;
  const double expected =
      mu * (stack_bsdf(layer_stack(material, 0), std::acos(mu), zero, zero).brdf[0] - mirrored);
  return mean_inside(render(scene).image, 0) / expected;
}

// Found through facets and where paths meet the rough boundary.
TEST(WalkMedia, WidePlateWithARoughBoundaryScattersALampAsAddingDoublingHasIt) {
  EXPECT_NEAR(scattered_over_expected(rough_medium(0.3, 0.5), 160), 1.0, 0.015);
}

// The same through a boundary of layers, which refracts on the way out.
TEST(WalkMedia, RoughLayersOfTwoIndicesScatterALampAsAddingDoublingHasIt) {
  Material material = layers_of_two_indices(0.2, 0.0);
  material.layers[0].top = {.roughness = 0.5, .distribution = MicrofacetDistribution::ggx};
  EXPECT_NEAR(scattered_over_expected(material, 480), 1.0, 0.02);
}

// The same light as a lamp, which searches and paths share, and as a part of the sky, which paths
// alone find.
TEST(WalkMedia, RoughBoundaryPassesALampAsItPassesSky) {
  const Light lamp = RectangleLight{
      .center = {0, 0, 1}, .edge_u = {400, 0, 0}, .edge_v = {0, -400, 0}, .radiance = {2, 2, 2}};
  const Scene scene = scene_of(make_plate(20.0f, 10.0f), rough_medium(0.3, 0.3), lamp, 96);
  Scene open = scene;
  open.lights = {EnvironmentLight{.scale = {2, 2, 2}}};
  open.render.samples_per_pixel = 600;
  const double of_sky = mean_inside(render(open).image, 0);
  EXPECT_GT(of_sky, 0.2);
  EXPECT_NEAR(mean_inside(render(scene).image, 0), of_sky, 0.03 * of_sky);
}

TEST(WalkMedia, WidePlateOfLayersOfTwoIndicesReflectsAsAddingDoublingHasIt) {
  for (const double roughness : {0.0, 0.4}) {
    const Material material = layers_of_two_indices(0.2, roughness);
    const Scene scene = scene_of(make_plate(60.0f, 30.0f), material, EnvironmentLight{}, 96);
    const double expected = adding_doubling(layer_stack(material, 0)).totals.diffuse_reflectance;
    EXPECT_NEAR(mean_inside(render(scene).image, 0), expected, 0.02 * expected) << roughness;
  }
}

TEST(WalkMedia, WhiteBallOfLayersOfTwoIndicesIsInvisibleInEvenLight) {
  Scene scene = scene_of(make_sphere(0.6f), layers_of_two_indices(0.0, 0.0), EnvironmentLight{}, 6);
  scene.camera = camera_above(0.8);
  EXPECT_NEAR(mean_of(render(scene).image, 0), 1.0, 0.01);
}

// Three layers of three indices, 0.08 mm thick together, on a ball that they are thin against: what
// a flat stack reflects straight up.
TEST(WalkMedia, LargeBallOfSkinReflectsAsFlatSkin) {
  const Material skin = find_material("donner_jensen_skin");
  Scene scene = scene_of(make_sphere(60.0f, 96), skin, EnvironmentLight{}, 32);
  scene.camera = {.position = {900, 0, 20}, .up = {0, 1, 0}, .horizontal_fov = 0.001};
  const Image image = render(scene).image;
  for (std::size_t c = 0; c < 3; ++c) {
    const double expected = adding_doubling(layer_stack(skin, c)).totals.diffuse_reflectance;
    EXPECT_NEAR(mean_inside(image, c), expected, 0.04 * expected) << c;
  }
}

TEST(WalkMedia, RefusesLightsWithoutAnAreaOverLayersOfDifferentIndices) {
  const Scene scene =
      scene_of(make_sphere(1.0f), layers_of_two_indices(0.1, 0.0),
               DirectionalLight{.direction = {0, 0, 1}, .irradiance = {1, 1, 1}}, 1);
  try {
    (void)render(scene);
    FAIL();
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find("layers of different ior"), std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace lamina

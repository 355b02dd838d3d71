// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/random_walk/random_walk.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "lamina/base/core/error.h"
#include "lamina/base/core/parallel.h"
#include "lamina/base/core/quadrature.h"
#include "lamina/layers/materials/material.h"
#include "lamina/layers/optics/fresnel.h"
#include "render/small_scenes.h"
#include "render/subsurface/random_walk/walk_means.h"
#include "solve/scattering/monte_carlo/ball_photons.h"

namespace lamina {
namespace {

Material homogeneous(std::vector<double> sigma_a, std::vector<double> sigma_s, double g,
                     double ior) {
  return material_of({layer_of(std::move(sigma_a), std::move(sigma_s), g, infinite, ior)});
}

Scene scene_of(Mesh mesh, Material material, Light light, int samples) {
  Scene scene;
  mesh.is_closed = true;
  scene.camera = camera_above(1.0);
  scene.film = {.width = 8, .height = 8};
  scene.render = {.method = RenderSettings::Method::random_walk, .samples_per_pixel = samples};
  scene.materials = {
      {.name = "medium", .surface = SubsurfaceSurface{.material = std::move(material)}}};
  scene.meshes = {std::move(mesh)};
  scene.lights = {light};
  return scene;
}

/// Mean of a channel over the disc of a sphere that touches the borders of the picture.
double mean_of_disc(const Image& image, std::size_t channel) {
  return mean_of(image, channel) * 4.0 / std::numbers::pi;
}

// What does not absorb returns all light of an even sky, in every direction: mirrored or from
// inside.
TEST(RandomWalk, WhiteObjectInEvenLightIsInvisible) {
  for (const double g : {0.0, 0.7}) {
    Scene scene = scene_of(make_sphere(3.0f), homogeneous({0, 0, 0}, {1, 1, 1}, g, 1.3),
                           EnvironmentLight{}, 256);
    scene.camera = camera_above(4.0);
    const Image image = render(scene).image;
    for (int y = 0; y < 8; ++y)
      for (int x = 0; x < 8; ++x) EXPECT_NEAR(image.at(x, y)[0], 1.0f, 0.012f) << x << ' ' << y;
  }
}

// The same where bands differ by any ratio, though one path serves all of them: the light is there
// in every band and pixel.
TEST(RandomWalk, WhiteObjectsOfBandsThatDifferMuchAreInvisible) {
  const auto check = [](Material material, double ratio) {
    Scene scene = scene_of(make_sphere(3.0f), std::move(material), EnvironmentLight{}, 64);
    scene.camera = camera_above(4.0);
    const Image image = render(scene).image;
    for (std::size_t c = 0; c < 3; ++c) {
      double sum = 0.0, squares = 0.0;
      for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 8; ++x) {
          const double off = static_cast<double>(image.at(x, y)[c]) - 1.0;
          EXPECT_LT(std::abs(off), 0.4) << ratio << ' ' << x << ' ' << y << ' ' << c;
          sum += off / 64.0;
          squares += off * off / 64.0;
        }
      EXPECT_LT(std::abs(sum), 4.0 * std::sqrt(squares / 64.0)) << ratio << ' ' << c;
      EXPECT_LT(std::sqrt(squares), 0.12) << ratio << ' ' << c;
    }
  };
  for (const double ratio : {1.0, 10.0, 100.0})
    for (const double roughness : {0.0, 0.3}) {
      Material material =
          homogeneous({0, 0, 0}, {0.3, 0.3 * std::sqrt(ratio), 0.3 * ratio}, 0.0, 1.5);
      material.layers[0].top.roughness = roughness;
      check(material, ratio);
    }
}

/// Mean of a channel of what leaves a ball of the medium in light of radiance 1.
std::vector<double> albedo_of_ball(const Material& material, double radius, int samples) {
  Scene scene =
      scene_of(make_sphere(static_cast<float>(radius), 96), material, EnvironmentLight{}, samples);
  scene.camera = camera_above(2.0 * radius);
  scene.film = {.width = 32, .height = 32};
  const Image image = render(scene).image;
  std::vector<double> albedo;
  for (const char* name : {"subsurface.R", "subsurface.G", "subsurface.B"})
    albedo.push_back(mean_of_disc(image, channel_index(image, name).value()));
  return albedo;
}

// Jensen's skin1 as a ball of 10 mm in even light, as it is and ten times as dense, by two others:
// - Photons one by one in an exact sphere (solve/scattering/monte_carlo/ball_photons.h): by six
//   million of them it is
//   .5447(1) .2399(1) .1220(1), and .4258(1) .2061(1) .1115(1) ten times as dense.
// - The volumetric path tracer of pbrt-v3: a smooth sphere of index 1.33, not the 1.3 of the
//   built-in material, of radius 10 mm, with skin1's coefficients, in light of radiance 1 all
//   around. Three digits, its noise not stated.
// Of 64 samples the noise is .35 % (of four seeds); the mesh and what grazes it take up to .2 %.
TEST(RandomWalk, BallOfSkinHasTheAlbedoOfPhotonsAndOfPbrt) {
  constexpr double radius = 10.0, noise = 0.0035, of_mesh = 0.002;
  const double pbrt[] = {0.543, 0.239, 0.121};
  for (const double density : {1.0, 10.0}) {
    Material skin = find_material("jensen_skin1");
    MaterialLayer& layer = skin.layers[0];
    layer.ior = skin.ior_below = {1.33, 1.33, 1.33};
    for (double& sigma : layer.sigma_a) sigma *= density;
    for (double& sigma : layer.sigma_s) sigma *= density;
    const std::vector<double> albedo = albedo_of_ball(skin, radius, 64);
    for (std::size_t c = 0; c < 3; ++c) {
      constexpr int photons = 300'000;
      const reference::ScalarSum leaving = reference::trace_ball_photons(
          {.sigma_a = layer.sigma_a[c], .sigma_s = layer.sigma_s[c], .ior = 1.33}, radius, photons,
          c + 1);
      const double expected = leaving.mean(photons);
      EXPECT_NEAR(
          albedo[c], expected,
          of_mesh * expected + 3.0 * std::hypot(leaving.standard_error(photons), noise * expected))
          << density << ' ' << c;
      if (density == 1.0) {
        EXPECT_NEAR(albedo[c], pbrt[c], 0.0005 + 3.0 * noise * pbrt[c]) << c;
      }
    }
  }
}

/// Chandrasekhar's function of isotropic scattering. Source: [Chandrasekhar1960] §39, Eq. 14.
double h_function(double mu, double albedo) {
  const Quadrature rule = gauss_legendre(32, 0.0, 1.0);
  std::vector<double> h(rule.nodes.size(), 1.0);
  const auto value = [&](double at) {
    double sum = 0.0;
    for (std::size_t i = 0; i < h.size(); ++i)
      sum += rule.weights[i] * rule.nodes[i] * h[i] / (at + rule.nodes[i]);
    return 1.0 / (std::sqrt(1.0 - albedo) + 0.5 * albedo * sum);
  };
  for (int round = 0; round < 200; ++round) {
    std::vector<double> next;
    for (const double node : rule.nodes) next.push_back(value(node));
    h = next;
  }
  return value(mu);
}

// A thick wide plate under a distant light is a half-space: radiance by Chandrasekhar's law of
// diffuse reflection, all orders.
TEST(RandomWalk, ThickPlateReflectsAsChandrasekharsHalfSpace) {
  const double mu_0 = 0.6;
  const Scene scene =
      scene_of(make_plate(60.0f, 30.0f), homogeneous({0.1, 0.5, 1.0}, {0.9, 0.5, 1.0}, 0.0, 1.0),
               DirectionalLight{.direction = {0.8, 0, mu_0}, .irradiance = {1, 1, 1}}, 512);
  const Image image = render(scene).image;
  const double albedo[3] = {0.9, 0.5, 0.5};
  for (std::size_t c = 0; c < 3; ++c) {
    const double w = albedo[c];
    const double expected = 0.25 * std::numbers::inv_pi * w * mu_0 / (mu_0 + 1.0) *
                            h_function(mu_0, w) * h_function(1.0, w);
    EXPECT_NEAR(mean_of(image, c), expected, 0.01 * expected) << c;
  }
}

// A distant light on a ball that does not absorb: what leaves in all directions together is what
// enters, through a refracting boundary that focuses; a thousandth passes without an event.
TEST(RandomWalk, BallReturnsAllLightOfALampThatEnters) {
  const double ior = 1.4, radius = 2.0;
  double flux = 0.0;
  const Quadrature rule = gauss_legendre(6, -1.0, 1.0);
  for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
    const double mu = rule.nodes[i];
    Scene scene = scene_of(
        make_sphere(2.0f, 96), homogeneous({0, 0, 0}, {2.5, 2.5, 2.5}, 0.0, ior),
        DirectionalLight{.direction = {std::sqrt(1.0 - mu * mu), 0, mu}, .irradiance = {1, 1, 1}},
        24);
    scene.camera = camera_above(2.0 * radius);
    scene.film = {.width = 16, .height = 16};
    const Image image = render(scene).image;
    const std::size_t channel = channel_index(image, "subsurface.G").value();
    flux +=
        2.0 * std::numbers::pi * rule.weights[i] * mean_of(image, channel) * 4.0 * radius * radius;
  }
  const double entering = std::numbers::pi * radius * radius * (1.0 - fresnel_diffuse(ior));
  EXPECT_NEAR(flux, entering, 0.02 * entering);
}

/// A black world around.
class NoLight final : public LightGatherer<4> {
 public:
  BandValues<4> entering_irradiance(const SurfacePoint&, PixelSamples&) const override {
    return {};
  }
  BandValues<4> shadow_transmittance(const Ray&, float) const override {
    return BandValues<4>::filled(1.0f);
  }
  BandValues<4> arriving_radiance(const Ray&, PixelSamples&) const override { return {}; }
};

/// A square of 0.4 rad in a dark sky, 0.4 rad from +z.
Image make_compact_sky() {
  Image map = make_image(64, 32, {"R", "G", "B"});
  for (int y = 12; y < 16; ++y)
    for (int x = 2; x < 6; ++x)
      for (int c = 0; c < 3; ++c) map.at(x, y)[c] = 6.0f;
  return map;
}

// What is known beforehand saves work and must not count: none of it, all of it, and twice as much
// light as there is give the same mean, for isotropic and forward scattering, under a lamp and
// under a bright place in the sky.
TEST(RandomWalk, HasTheSameMeanWhateverIsKnownBeforehand) {
  const Light lamp = RectangleLight{
      .center = {6, 0, 9}, .edge_u = {0, 4, 0}, .edge_v = {3.33, 0, -2.22}, .radiance = {5, 5, 5}};
  const Light sky = EnvironmentLight{.image = 0};
  for (const auto& [g, light] : {std::pair{0.0, lamp}, {0.6, lamp}, {0.6, sky}}) {
    Scene scene =
        scene_of(make_sphere(3.0f), homogeneous({0.1, 0.3, 0.8}, {1, 1.2, 1.5}, g, 1.3), light, 1);
    scene.images = {make_compact_sky()};
    const RenderScene prepared(scene);
    const auto conversion =
        make_band_conversion<4>(BandSet::rgb(), make_band_weights(BandSet::rgb()));
    const Hit hit = prepared.geometry.first_hit({{0.5f, 0.3f, 9}, {0, 0, -1}}, 0.0f);
    const SurfacePoint point = make_surface_point(scene.meshes, hit, 0.0f);
    const ExitPoint exit{point, boundary_at(prepared, point), point.normal.z, {0, 0, 1}};
    WalkMeans of[3];
    for (std::size_t kind = 0; kind < 3; ++kind) {
      RandomWalk<4> walk(make_walk_media<4>(prepared, conversion), 0);
      if (kind > 0) {
        ASSERT_TRUE(walk.solve_radiance_field(NoLight{}, {}, kind == 2 ? 2.0f : 1.0f));
      }
      of[kind] = walk_means(walk, exit, NoLight{});
      for (std::size_t b = 0; b < 3; ++b) {
        EXPECT_LT(of[kind].error[b], 0.06 * of[kind].mean[b]) << kind << ' ' << b;
      }
    }
    for (const std::size_t kind : {1u, 2u})
      for (std::size_t b = 0; b < 3; ++b)
        EXPECT_NEAR(of[kind].mean[b], of[0].mean[b],
                    3.5 * std::hypot(of[0].error[b], of[kind].error[b]))
            << "g " << g << " light " << light.index() << " kind " << kind << " band " << b;
  }
}

// Under a sky paths leave, in the dark they stay and carry less. Both ways have the same mean: of
// what a lamp sends in, and of a wall outside.
TEST(RandomWalk, HasTheSameMeanWhetherPathsLeaveOrStay) {
  Scene scene =
      scene_of(make_sphere(1.5f, 48), homogeneous({0.02, 0.1, 0.4}, {1, 1.2, 2.5}, 0.0, 1.4),
               RectangleLight{.center = {6, 0, 9},
                              .edge_u = {0, 4, 0},
                              .edge_v = {3.33, 0, -2.22},
                              .radiance = {5, 5, 5}},
               192);
  Mesh wall = make_plate(6.0f, 0.1f);
  for (Vec3f& p : wall.positions) p.z -= 2.0f;
  scene.materials.push_back({.name = "wall", .surface = DiffuseSurface{}});
  wall.material.assign(wall.triangles.size(), 1);
  scene.meshes.push_back(wall);
  scene.camera = camera_above(2.0);
  const Image stay = render(scene).image;
  scene.lights.push_back(EnvironmentLight{.scale = {0, 0, 0}});
  const Image leave = render(scene).image;
  for (const char* name : {"subsurface.R", "subsurface.G", "subsurface.B"}) {
    const std::size_t channel = channel_index(stay, name).value();
    const double expected = mean_of(leave, channel);
    EXPECT_NEAR(mean_of(stay, channel), expected, 0.01 * expected) << name;
  }
}

/// Walks in the first material of a scene.
struct PreparedWalk {
  RenderScene scene;
  BandConversion<4> conversion =
      make_band_conversion<4>(BandSet::rgb(), make_band_weights(BandSet::rgb()));
  RandomWalk<4> walk{make_walk_media<4>(scene, conversion), 0};

  explicit PreparedWalk(const Scene& of) : scene(of) {}
  [[nodiscard]] bool solve() { return walk.solve_radiance_field(NoLight{}, {}); }
};

struct LeavingLight {
  double mean, error, most;
};

/// The light that leaves the top of a body along z.
LeavingLight leaving_at(const PreparedWalk& prepared, Vec2f at, std::uint32_t count, int band = 0) {
  const auto& [scene, conversion, walk] = prepared;
  const Hit hit = scene.geometry.first_hit({{at.x, at.y, 100}, {0, 0, -1}}, 0.0f);
  const SurfacePoint point = make_surface_point(scene.scene->meshes, hit, 0.0f);
  const ExitPoint exit{point, boundary_at(scene, point), point.normal.z, {0, 0, 1}};
  double sum = 0.0, squares = 0.0, most = 0.0;
  for (std::uint32_t i = 0; i < count; ++i) {
    PixelSamples samples(11, i, 0);
    const auto value = static_cast<double>(walk.leaving_radiance(exit, NoLight{}, samples)[band]);
    sum += value;
    squares += value * value;
    most = std::max(most, value);
  }
  const double mean = sum / count;
  return {mean, std::sqrt((squares / count - mean * mean) / count), most};
}

/// A white body among lamps that shine from all around.
Scene among_lamps(Mesh body, double sigma_s) {
  Scene scene =
      scene_of(std::move(body), homogeneous({0, 0, 0}, {sigma_s, sigma_s, sigma_s}, 0.0, 1.4),
               EnvironmentLight{.scale = {0, 0, 0}}, 1);
  scene.lights.clear();
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-6.0, 6.0}) {
      Vec3 center, u, v;
      center[axis] = side;
      u[(axis + 1) % 3] = 12.0;
      v[(axis + 2) % 3] = side > 0.0 ? -12.0 : 12.0;
      scene.lights.push_back(
          RectangleLight{.center = center, .edge_u = u, .edge_v = v, .radiance = {1, 1, 1}});
    }
  return scene;
}

// A white cube among lamps looks as bright as they, at its corner as elsewhere: no way by which
// light enters is missed or counted twice, through one face, another, or mirrored inside.
TEST(RandomWalk, WhiteCubeAmongLampsIsAsBrightAsThey) {
  const Scene scene = among_lamps(make_cube(2.0f), 1.0);
  PreparedWalk prepared(scene);
  for (const bool is_solved : {false, true}) {
    if (is_solved) {
      ASSERT_TRUE(prepared.solve());
    }
    for (const float offset : {0.9f, 0.5f}) {
      const auto [mean, error, most] = leaving_at(prepared, {offset, offset}, 2048);
      EXPECT_NEAR(mean, 1.0 - fresnel(1.0, 1.4), 3.5 * error);
      EXPECT_LT(error, 0.01);
    }
  }
}

// So does a clear white ball: light that its curved boundary reflects inside, and that of the folds
// of its caustics, counts once, between paths that meet the lamps by chance and light vertices.
TEST(RandomWalk, WhiteBallAmongLampsIsAsBrightAsTheyWithLightVertices) {
  const Scene scene = among_lamps(make_sphere(1.5f, 96), 0.6);
  PreparedWalk prepared(scene);
  ASSERT_TRUE(prepared.solve());
  ASSERT_TRUE(prepared.walk.trace_light_vertices(NoLight{}, {}));
  constexpr double offset = 0.4, radius = 1.5;
  const double cosine = std::sqrt(1.0 - std::pow(offset / radius, 2));
  const auto [mean, error, most] = leaving_at(prepared, {static_cast<float>(offset), 0.0f}, 40'000);
  EXPECT_NEAR(mean, 1.0 - fresnel(cosine, 1.4), 3.5 * error);
  EXPECT_LT(error, 0.0015);
}

// Beside an edge light comes through two faces and by reflection. None of that is left to paths
// that meet the lamp by chance: they are worth hundreds of others.
TEST(RandomWalk, HasNoFirefliesAtAnEdge) {
  const Scene scene = scene_of(make_cube(20.0f), homogeneous({0.05, 0.1, 0.2}, {1, 1, 1}, 0.0, 1.4),
                               RectangleLight{.center = {30, 0, 20},
                                              .edge_u = {0, 4, 0},
                                              .edge_v = {2.22, 0, -3.33},
                                              .radiance = {50, 50, 50}},
                               1);
  PreparedWalk prepared(scene);
  ASSERT_TRUE(prepared.solve());
  const auto [mean, error, most] = leaving_at(prepared, {9.5f, 0.0f}, 8192);
  EXPECT_LT(most, 10.0 * mean);
}

// Each single walk sees a lamp straight through a sheet that absorbs, as bright as Bouguer's law
// and the Airy sum of Fresnel's reflections have it; under a sky, too, where later on paths leave
// by chance.
TEST(RandomWalk, SeesALampThroughAThinSheetWithoutNoise) {
  const std::vector<double> sigma_a = {0.5, 1.0, 2.0};
  constexpr double thickness = 2.0, ior = 1.4, radiance = 5.0;
  Scene scene = scene_of(make_plate(6.0f, static_cast<float>(thickness)),
                         homogeneous(sigma_a, {0, 0, 0}, 0.0, ior),
                         RectangleLight{.center = {0, 0, -20},
                                        .edge_u = {20, 0, 0},
                                        .edge_v = {0, 20, 0},
                                        .radiance = {radiance, radiance, radiance}},
                         1);
  for (const bool has_sky : {false, true}) {
    if (has_sky) scene.lights.push_back(EnvironmentLight{.scale = {0, 0, 0}});
    const RenderScene prepared(scene);
    const auto conversion =
        make_band_conversion<4>(BandSet::rgb(), make_band_weights(BandSet::rgb()));
    const RandomWalk<4> walk(make_walk_media<4>(prepared, conversion), 0);
    const Hit hit = prepared.geometry.first_hit({{0.3f, 0.2f, 3}, {0, 0, -1}}, 0.0f);
    const SurfacePoint point = make_surface_point(scene.meshes, hit, 0.0f);
    const ExitPoint exit{point, boundary_at(prepared, point), 1.0f, {0, 0, 1}};
    for (std::uint32_t i = 0; i < 64; ++i) {
      PixelSamples samples(11, i, 0);
      const BandValues<4> found = walk.leaving_radiance(exit, NoLight{}, samples);
      for (std::size_t b = 0; b < 3; ++b) {
        const double mirrored = fresnel(1.0, ior), passing = std::exp(-sigma_a[b] * thickness);
        const double expected = radiance * std::pow(1.0 - mirrored, 2) * passing /
                                (1.0 - std::pow(mirrored * passing, 2));
        EXPECT_NEAR(static_cast<double>(found[static_cast<int>(b)]), expected, 2e-3 * expected)
            << has_sky << ' ' << i << ' ' << b;
      }
      EXPECT_EQ(largest(walk.scattered_radiance(exit, NoLight{}, samples)), 0.0f);
    }
  }
}

TEST(RandomWalk, StopsPreparingWhenAsked) {
  const Scene scene = scene_of(make_sphere(3.0f), homogeneous({0.1, 0.1, 0.1}, {2, 2, 2}, 0.0, 1.3),
                               PointLight{.position = {0, 0, 9}}, 1);
  const RenderScene prepared(scene);
  const auto conversion =
      make_band_conversion<4>(BandSet::rgb(), make_band_weights(BandSet::rgb()));
  RandomWalk<4> walk(make_walk_media<4>(prepared, conversion), 0);
  std::atomic<int> reports = 0;
  EXPECT_FALSE(walk.solve_radiance_field(NoLight{}, [&](double finished) {
    EXPECT_EQ(finished, 0.0);
    return ++reports < 3;
  }));
  EXPECT_LT(reports, 3 + thread_count());
  EXPECT_TRUE(walk.solve_radiance_field(NoLight{}, {}));
}

TEST(RandomWalk, RefusesOpenMeshes) {
  Scene scene = scene_of(make_square(1.0f), homogeneous({0, 0, 0}, {1, 1, 1}, 0.0, 1.3),
                         EnvironmentLight{}, 1);
  scene.meshes[0].is_closed = false;
  EXPECT_THROW((void)render(scene), InvalidInput);
}

TEST(RandomWalk, NamesTheOpenPartAndLeavesOthersAlone) {
  Scene scene = scene_of(make_plate(1e4f, 1e4f), homogeneous({0, 0, 0}, {1, 1, 1}, 0.0, 1.3),
                         EnvironmentLight{}, 1);
  Mesh& mesh = scene.meshes[0];
  mesh.is_closed = false;
  mesh.open_parts = {{.name = "hair", .edges = 12, .place = {1, 2, 3}, .materials = {7}}};
  EXPECT_NO_THROW((void)render(scene));  // material 0 is on closed surfaces only
  mesh.open_parts[0].materials = {0, 7};
  try {
    (void)render(scene);
    FAIL() << "it was rendered";
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what())
                  .find("part \"hair\" is open: 12 edges do not join two faces, the first at (1, "
                        "2, 3) mm"),
              std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace lamina

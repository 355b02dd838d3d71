// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "lamina/base/core/error.h"
#include "lamina/base/core/parallel.h"
#include "lamina/base/core/quadrature.h"
#include "lamina/base/core/random.h"
#include "lamina/layers/optics/fresnel.h"
#include "lamina/render/subsurface/profiles/gather_table.h"
#include "lamina/render/subsurface/profiles/profile_maker.h"
#include "lamina/solve/scattering/diffusion/diffusion_profile.h"
#include "lamina/solve/scattering/diffusion/layered_diffusion.h"
#include "render/small_scenes.h"

namespace lamina {
namespace {

constexpr float pi_f = std::numbers::pi_v<float>;

/// One layer; three bands with the same scattering.
Material one_layer(std::vector<double> sigma_a, double sigma_s, double ior,
                   double thickness = std::numeric_limits<double>::infinity()) {
  Material material{.name = "test", .ior_above = {1, 1, 1}, .ior_below = {ior, ior, ior}};
  if (std::isfinite(thickness)) material.ior_below = {1, 1, 1};
  material.layers = {{.name = "layer",
                      .sigma_a = std::move(sigma_a),
                      .sigma_s = {sigma_s, sigma_s, sigma_s},
                      .g = {0, 0, 0},
                      .ior = {ior, ior, ior},
                      .thickness = thickness}};
  return material;
}

SurfaceMaterial translucent(Material material) {
  return {
      .name = "translucent",
      .surface = SubsurfaceSurface{.material = std::move(material), .thickness = {.value = 0.0f}}};
}

/// The middle of a square of the material in even light, seen from above.
Scene furnace(Material material, float size, int samples) {
  Scene scene;
  scene.camera = camera_above(0.5);
  scene.film = {.width = 8, .height = 8};
  scene.render = {.method = RenderSettings::Method::probe,
                  .profile = RenderSettings::Profile::diffusion,
                  .samples_per_pixel = samples,
                  .max_bounces = 0};
  scene.materials = {translucent(std::move(material))};
  scene.meshes = {make_square(size)};
  scene.lights = {EnvironmentLight{}};
  return scene;
}

// Light spreads 1.67 mean free paths / distance beyond a distance; the patch ends after 2500 of
// them, which leaves 7e-4, and the table puts the last .2 % back within its reach.
TEST(SubsurfaceFurnace, WhiteMatchedPatchReturnsAllLight) {
  const Scene scene = furnace(one_layer({0, 0, 0}, 50.0, 1.0), 100.0f, 256);
  const Image image = render(scene).image;
  for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(mean_of(image, c), 1.0, 2e-3) << c;
}

// Even light from all sides: what a slab in diffuse light returns, mirrored and from inside.
TEST(SubsurfaceFurnace, AbsorbingPatchWithASurfaceReturnsTheSlabTotal) {
  const Material material = one_layer({0.01, 0.3, 3.0}, 10.0, 1.4);
  const Scene scene = furnace(material, 60.0f, 256);
  const Image image = render(scene).image;
  for (std::size_t c = 0; c < 3; ++c) {
    const SlabTotals slab = diffusion_totals(layer_stack(material, c), {.is_diffuse = true});
    // The slab sums over all directions what the camera sees along the normal: inside light leaves
    // by the transmittance there over its mean, and the mirror part is that of the normal.
    const double mirrored = fresnel(1.0, 1.4);
    const double inside =
        slab.diffuse_reflectance * (1.0 - mirrored) / (1.0 - fresnel_diffuse(1.4));
    EXPECT_NEAR(mean_of(image, c), mirrored + inside, 2e-3) << c;
  }
}

// The same through the camera: averaged over all directions of view the slab total comes out.
TEST(SubsurfaceFurnace, AveragedOverViewsThePatchReturnsTheSlabTotal) {
  const Material material = one_layer({0.01, 0.3, 3.0}, 10.0, 1.4);
  Scene scene = furnace(material, 60.0f, 64);
  scene.film = {.width = 4, .height = 4};
  double total[3] = {};
  const Quadrature rule = gauss_legendre(6, 0.0, 1.0);
  for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
    const double mu = rule.nodes[i], s = std::sqrt(1.0 - mu * mu);
    scene.camera.position = {50.0 * s, 0, 50.0 * mu};
    const Image image = render(scene).image;
    for (std::size_t c = 0; c < 3; ++c) total[c] += 2.0 * mu * rule.weights[i] * mean_of(image, c);
  }
  for (std::size_t c = 0; c < 3; ++c) {
    const SlabTotals slab = diffusion_totals(layer_stack(material, c), {.is_diffuse = true});
    // Six nodes over the Fresnel curve, whose rise near grazing they miss by some 3e-3.
    EXPECT_NEAR(total[c], slab.diffuse_reflectance + slab.specular_reflectance, 5e-3) << c;
  }
}

// A shadow edge: with light on x > 0 only, the flux leaving at x is the profile integrated over the
// lit half, 1/2 at the edge. A projector is made from a far rectangle behind a knife.
TEST(Subsurface, LightSpreadsUnderAShadowEdgeAsTheProfileSays) {
  const Material material = one_layer({0.05, 0.2, 1.0}, 4.0, 1.0);
  Scene scene = furnace(material, 60.0f, 256);
  Mesh knife = make_square(60.0f, 1);
  for (Vec3f& p : knife.positions) p = p + Vec3f{-30.0f, 0.0f, 5.0f};
  scene.meshes.push_back(knife);
  scene.materials.push_back(diffuse_material(0.0f));
  scene.lights = {DirectionalLight{.direction = {0, 0, 1}, .irradiance = {pi_f, pi_f, pi_f}}};
  // Seen from the lit side below the knife.
  scene.camera = {
      .position = {40, 0, 4}, .look_at = {0, 0, 0}, .up = {0, 0, 1}, .horizontal_fov = 2e-5};
  scene.film = {.width = 1, .height = 1};
  const Profile profile = diffusion_profile(material);
  for (const double x : {-0.5, 0.0, 1.0}) {
    scene.camera.look_at = {x, 0, 0};
    scene.render.samples_per_pixel = 16384;
    const Image image = render(scene).image;
    for (std::size_t c = 0; c < 3; ++c) {
      // Fraction of the profile within the half-plane at distance x: over rings, the share of each
      // that lies beyond the edge.
      double dark = 0.0, all = profile.total_reflectance[c];
      for (std::size_t i = 0; i + 1 < profile.r.size(); ++i) {
        const double r = std::sqrt(profile.r[i] * profile.r[i + 1]);
        const double ring =
            std::numbers::pi * (profile.r[i + 1] * profile.r[i + 1] - profile.r[i] * profile.r[i]) *
            std::sqrt(profile.reflectance_at(i, c) * profile.reflectance_at(i + 1, c));
        if (r > std::abs(x)) dark += ring * std::acos(std::abs(x) / r) / std::numbers::pi;
      }
      const double lit = x < 0.0 ? dark : all - dark;
      EXPECT_NEAR(mean_of(image, c), lit, 0.01 * all) << x << ' ' << c;
    }
  }
}

// A slab lit from behind: what passes it is its diffuse transmittance.
TEST(Subsurface, LightPassesAThinPlate) {
  const Material material = one_layer({0.01, 0.1, 0.5}, 3.0, 1.0, 1.0);
  Scene scene = furnace(material, 80.0f, 256);
  Mesh& front = scene.meshes[0];
  const std::size_t corners = front.positions.size();
  for (std::size_t i = 0; i < corners; ++i) {  // the back, 1 mm below, facing down
    front.positions.push_back(front.positions[i] - Vec3f{0, 0, 1});
    front.normals.push_back({0, 0, -1});
    front.uvs.push_back(front.uvs[i]);
  }
  front.triangles.push_back({4, 6, 5});
  front.triangles.push_back({4, 7, 6});
  front.material.assign(4, 0);
  scene.lights = {DirectionalLight{.direction = {0, 0, -1}, .irradiance = {pi_f, pi_f, pi_f}}};
  const Profile profile = diffusion_profile(material);
  const Image image = render(scene).image;
  for (std::size_t c = 0; c < 3; ++c) {
    // What the profile holds; light that passes unscattered is not in it.
    double scattered = 0.0;
    for (std::size_t i = 0; i + 1 < profile.r.size(); ++i)
      scattered += std::numbers::pi *
                   (profile.r[i + 1] * profile.r[i + 1] - profile.r[i] * profile.r[i]) * 0.5 *
                   (profile.transmittance_at(i, c) + profile.transmittance_at(i + 1, c));
    EXPECT_NEAR(mean_of(image, c), scattered, 0.02 * scattered) << c;
  }
}

// A half-space material on a thin object lets light through as a slab of the object's thickness.
TEST(Subsurface, AThinObjectOfAHalfSpaceMaterialTransmitsAsASlab) {
  Scene scene = furnace(one_layer({0.01, 0.1, 0.5}, 3.0, 1.0), 80.0f, 256);
  scene.meshes[0] = make_square(80.0f);
  Mesh& front = scene.meshes[0];
  for (std::size_t i = 0; i < 4; ++i) {
    front.positions.push_back(front.positions[i] - Vec3f{0, 0, 1.5f});
    front.normals.push_back({0, 0, -1});
    front.uvs.push_back(front.uvs[i]);
  }
  front.triangles.push_back({4, 6, 5});
  front.triangles.push_back({4, 7, 6});
  front.material.assign(4, 0);
  scene.lights = {DirectionalLight{.direction = {0, 0, -1}, .irradiance = {pi_f, pi_f, pi_f}}};
  const Image image = render(scene).image;
  const Material slab = one_layer({0.01, 0.1, 0.5}, 3.0, 1.0, 1.5);
  const Profile profile = diffusion_profile(slab);
  for (std::size_t c = 0; c < 3; ++c) {
    // Interpolated between slabs a factor of sqrt(2) apart.
    EXPECT_NEAR(mean_of(image, c), profile.total_transmittance[c],
                0.06 * profile.total_transmittance[c] + 0.01)
        << c;
  }
}

// The colour map is the diffuse reflectance that comes out, whatever the material's own is.
TEST(Subsurface, InvertedColorIsTheReflectanceThatComesOut) {
  Scene scene = furnace(one_layer({0.05, 0.3, 2.0}, 10.0, 1.0), 60.0f, 256);
  auto& surface = std::get<SubsurfaceSurface>(scene.materials[0].surface);
  surface.color_use = SubsurfaceSurface::ColorUse::invert;
  surface.color.value = {0.7f, 0.4f, 0.1f};
  const Image image = render(scene).image;
  const double expected[3] = {0.7, 0.4, 0.1};
  for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(mean_of(image, c), expected[c], 0.005) << c;
}

TEST(Subsurface, SameImageForAnyNumberOfThreads) {
  Scene scene = furnace(one_layer({0.05, 0.3, 2.0}, 10.0, 1.3), 20.0f, 8);
  scene.meshes = {make_sphere(8.0f)};
  scene.camera = camera_above(20.0);
  scene.film = {.width = 40, .height = 40};
  scene.render.max_bounces = 2;
  set_thread_count(1);
  const Image one = render(scene).image;
  set_thread_count(3);
  const Image three = render(scene).image;
  set_thread_count(0);
  EXPECT_EQ(one.pixels, three.pixels);
  for (const float value : one.pixels) EXPECT_FALSE(std::isnan(value));
}

// A non-absorbing sphere in even light loses only what the flat profile misses on a curved surface.
TEST(Subsurface, SphereInEvenLightHasNoBlackExits) {
  Scene scene = furnace(one_layer({0, 0, 0}, 20.0, 1.0), 1.0f, 256);
  scene.meshes = {make_sphere(5.0f)};
  scene.camera = camera_above(8.0);
  scene.film = {.width = 24, .height = 24};
  const Image image = render(scene).image;
  for (int y = 0; y < 24; ++y)
    for (int x = 0; x < 24; ++x) {
      EXPECT_GT(image.at(x, y)[0], 0.85f) << x << ' ' << y;
      EXPECT_LT(image.at(x, y)[0], 1.15f) << x << ' ' << y;
    }
}

// White light on a grey spectral material is grey, and coloured light keeps its colour.
TEST(Subsurface, SpectralBandsGiveTheSameColorsAsRgb) {
  for (const std::size_t count : {8, 16}) {
    std::vector<double> wavelengths;
    for (std::size_t b = 0; b < count; ++b)
      wavelengths.push_back(400.0 +
                            270.0 * static_cast<double>(b) / static_cast<double>(count - 1));
    Material spectral = one_layer({}, 10.0, 1.0);
    spectral.bands = BandSet(wavelengths);
    spectral.ior_above = spectral.ior_below = std::vector<double>(count, 1.0);
    spectral.layers[0] = {.sigma_a = std::vector<double>(count, 0.2),
                          .sigma_s = std::vector<double>(count, 10.0),
                          .g = std::vector<double>(count, 0.0),
                          .ior = std::vector<double>(count, 1.0)};
    Scene scene = furnace(spectral, 40.0f, 64);
    scene.lights = {EnvironmentLight{.scale = {1.0f, 0.5f, 0.25f}}};
    const Image image = render(scene).image;
    scene.materials = {translucent(one_layer({0.2, 0.2, 0.2}, 10.0, 1.0))};
    const Image rgb = render(scene).image;
    for (std::size_t c = 0; c < 3; ++c)
      EXPECT_NEAR(mean_of(image, c), mean_of(rgb, c), 2e-3) << count << ' ' << c;
  }
}

TEST(Subsurface, WarnsOfACameraThatSeesNothingTranslucent) {
  Scene scene = furnace(one_layer({0.05, 0.3, 2.0}, 10.0, 1.3), 20.0f, 1);
  EXPECT_TRUE(render(scene).statistics.warnings.empty());
  scene.camera.look_at = 2.0 * scene.camera.position - scene.camera.look_at;
  const std::vector<std::string> warnings = render(scene).statistics.warnings;
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_EQ(warnings[0],
            "the camera sees nothing translucent: does it look at the meshes, from outside?");
}

TEST(Subsurface, MoreThanSixteenBandsAreRefused) {
  std::vector<double> wavelengths;
  for (int b = 0; b < 17; ++b) wavelengths.push_back(400.0 + 10.0 * b);
  Material material = one_layer({0, 0, 0}, 20.0, 1.0);
  material.bands = BandSet(wavelengths);
  EXPECT_THROW((void)render(furnace(material, 1.0f, 1)), InvalidInput);
}

TEST(Subsurface, MaterialsOfDifferentBandsAreRefused) {
  Scene scene = furnace(one_layer({0, 0, 0}, 20.0, 1.0), 1.0f, 1);
  Material spectral = one_layer({0, 0, 0}, 20.0, 1.0);
  spectral.bands = BandSet({500, 550, 600});
  scene.materials.push_back(translucent(spectral));
  EXPECT_NO_THROW((void)render(scene));  // no mesh has it
  scene.meshes.push_back(scene.meshes[0]);
  std::ranges::fill(scene.meshes[1].material, 1U);
  EXPECT_THROW((void)render(scene), InvalidInput);
}

// Radii are drawn with the density that the table states.
TEST(ProfileTable, DrawsRadiiWithItsDensity) {
  const Profile profile = diffusion_profile(one_layer({0.01, 0.3, 3.0}, 10.0, 1.4));
  const ProfileTable<4> table(profile, make_radius_grid({profile}), BandValues<4>::filled(1.0f));
  // Mean of f(r) over drawn radii against its integral: f = exp(-r).
  Random random(4);
  double drawn = 0.0;
  constexpr int count = 200'000;
  for (int i = 0; i < count; ++i)
    drawn += std::exp(-static_cast<double>(table.sample_radius(random.uniform_float()))) / count;
  double integral = 0.0, mass = 0.0;
  const double log_first = std::log(1e-7),
               log_last = std::log(static_cast<double>(table.support_radius()));
  constexpr int steps = 40'000;
  for (int i = 0; i < steps; ++i) {
    const double r = std::exp(log_first + (i + 0.5) / steps * (log_last - log_first));
    const double ring = 2.0 * std::numbers::pi * r * r * (log_last - log_first) / steps *
                        static_cast<double>(table.density(static_cast<float>(r)));
    mass += ring;
    integral += ring * std::exp(-r);
  }
  EXPECT_NEAR(mass, 1.0, 2e-3);  // 40 000 steps over edges of 192 rings
  EXPECT_NEAR(drawn, integral, 2e-3);
}

// What a sample weighs, summed over the bands, is nearly the same at every radius: the density is
// even within a ring, over which a profile falls by up to a quarter.
TEST(ProfileTable, WeightsAreEvenOverTheBands) {
  const Profile profile = diffusion_profile(one_layer({0.01, 0.3, 3.0}, 10.0, 1.4));
  const ProfileTable<4> table(profile, make_radius_grid({profile}), BandValues<4>::filled(1.0f));
  const float expected = sum(table.total_reflectance());
  for (float r = 1e-4f; r < 0.9f * table.support_radius(); r *= 1.3f)
    EXPECT_NEAR(sum(table.reflectance_profile(r)) / table.density(r), expected, 0.15f * expected)
        << r;
}

}  // namespace
}  // namespace lamina
